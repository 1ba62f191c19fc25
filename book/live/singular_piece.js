export const singularPiece = () => null;
