(()=>{globalThis.labkitLive={};})();
