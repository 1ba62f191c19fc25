// Loads MuJoCo from compressed WebAssembly, which a script contains as base64, so it also works on file://.

export function unpacked(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(plain).arrayBuffer();
}

/** The module, which a page loads only once. */
export function mujoco() {
  return (globalThis.labkitMuJoCo ??= unpacked(globalThis.labkitMuJoCoPacked).then((wasmBinary) => {
    delete globalThis.labkitMuJoCoPacked;
    return globalThis.labkitLoadMuJoCo({ wasmBinary });
  }));
}
