// Quizzes answer at once; details open for print.  Nothing is stored and nothing is sent.
(function () {
  function answer(event) {
    var choice = event.target;
    var question = choice.closest && choice.closest(".lab-question");
    if (!question || choice.type !== "radio") return;
    var right = choice.value === question.dataset.right;
    var said = question.querySelector(".lab-said");
    said.textContent = (right ? "✓ Right. " : "✗ Not yet. ") + JSON.parse(question.dataset.said)[+choice.value];
    said.dataset.right = right;
    if (window.MathJax && window.MathJax.typesetPromise) window.MathJax.typesetPromise([said]);
  }
  document.addEventListener("change", answer);

  var closed = [];
  window.addEventListener("beforeprint", function () {
    closed = Array.prototype.filter.call(document.querySelectorAll(".lab-figure details, .lk-embed details"), function (d) { return !d.open; });
    closed.forEach(function (d) { d.open = true; });
  });
  window.addEventListener("afterprint", function () {
    closed.forEach(function (d) { d.open = false; });
  });
})();
