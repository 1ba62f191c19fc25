/* MathJax 3 settings of the book, and the one call of MathJax 2 that ipywidgets still makes.
   MyST-NB also assigns window.MathJax, before or after this file, so every assigned value is completed. */
(function () {
  var macros = { SE: "\\mathrm{SE}", SO: "\\mathrm{SO}", R: "\\mathbb{R}" };
  var classes = "tex2jax_process|mathjax_process|math|output_area";
  var hub = {
    Queue: function (call) {
      Promise.resolve(window.MathJax.startup && window.MathJax.startup.promise).then(function () {
        if (window.MathJax.typesetPromise) window.MathJax.typesetPromise([call[2]]);
      });
    }
  };
  function completed(value) {
    if (!value.version) { // settings, not yet MathJax itself
      value.options = Object.assign({ processHtmlClass: classes }, value.options);
      value.tex = Object.assign({}, value.tex);
      value.tex.macros = Object.assign({}, macros, value.tex.macros);
    }
    value.Hub = hub;
    return value;
  }
  var current = completed(window.MathJax || {});
  Object.defineProperty(window, "MathJax", {
    configurable: true,
    get: function () { return current; },
    set: function (value) { current = completed(value); }
  });
})();
