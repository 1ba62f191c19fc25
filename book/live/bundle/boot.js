(()=>{globalThis.x={};})();
