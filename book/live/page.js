globalThis.labkitLive = {};
