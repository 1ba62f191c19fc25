/* Widget packages (anywidget) and the widget manager's fonts are in npm/, beside this file. */
require.config({
  baseUrl: document.currentScript.src.split("?")[0].replace(/require-config\.js$/, "npm/")
});
