// MuJoCo from its packed WebAssembly, which a script left as base64: no fetch, so file:// will do.

export function unpacked(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(plain).arrayBuffer();
}

/** The module, once for the page. */
export function mujoco() {
  return (globalThis.labkitMuJoCo ??= unpacked(globalThis.labkitMuJoCoPacked).then((wasmBinary) => {
    delete globalThis.labkitMuJoCoPacked;
    return globalThis.labkitLoadMuJoCo({ wasmBinary });
  }));
}
