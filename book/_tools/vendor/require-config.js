/* Widget packages (anywidget) and the widget manager's fonts lie beside this file, in npm/. */
require.config({
  baseUrl: document.currentScript.src.split("?")[0].replace(/require-config\.js$/, "npm/")
});
