/* MathJax 3 settings of the book, and the one call of MathJax 2 that ipywidgets still makes. */
(function () {
  var hub = {
    Queue: function (call) {
      (window.MathJax.startup.promise || Promise.resolve()).then(function () {
        if (window.MathJax.typesetPromise) window.MathJax.typesetPromise([call[2]]);
      });
    }
  };
  window.MathJax = {
    Hub: hub,
    // Without this class list, MyST-NB's own setting is lost and all mathematics stays raw.
    options: { processHtmlClass: "tex2jax_process|mathjax_process|math|output_area" },
    tex: { macros: { SE: "\\mathrm{SE}", SO: "\\mathrm{SO}", R: "\\mathbb{R}" } },
    startup: {
      ready: function () {
        MathJax.startup.defaultReady();
        MathJax.Hub = hub;
      }
    }
  };
})();
