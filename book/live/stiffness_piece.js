export const stiffnessPiece = () => null;
