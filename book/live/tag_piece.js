export const tagPiece = () => null;
