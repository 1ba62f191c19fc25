globalThis.x = {};
