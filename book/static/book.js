// Quizzes, tables on phones, and open details in print.  Nothing is stored or sent.
(function () {
  function answer(event) {
    var choice = event.target;
    var question = choice.closest && choice.closest(".lab-question");
    if (!question || choice.type !== "radio") return;
    var right = choice.value === question.dataset.right;
    var said = question.querySelector(".lab-said");
    said.innerHTML = (right ? "✓ Right. " : "✗ Not yet. ") + JSON.parse(question.dataset.said)[+choice.value];
    said.dataset.right = right;
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

  // On a phone, a table that is too wide becomes a card for each row, one of numbers scrolls; for screen readers its roles keep it a table.
  var heads = function (table) { return Array.prototype.map.call(table.querySelectorAll("thead th, thead td"), function (h) { return h.textContent; }); };
  var fold = function () {
    document.querySelectorAll(".bd-article table:not(.lab-table), .lab-table:has(td.lab-words)").forEach(function (table) {
      table.classList.remove("lab-cards");
      var names = heads(table), box = table.parentElement;
      if (innerWidth > 700 || !names.length || box.scrollWidth <= box.clientWidth + 1) return;
      table.setAttribute("role", "table");
      table.querySelectorAll("thead, tbody").forEach(function (e) { e.setAttribute("role", "rowgroup"); });
      table.querySelectorAll("tr").forEach(function (row) {
        row.setAttribute("role", "row");
        Array.prototype.forEach.call(row.cells, function (cell, k) {
          var head = row.parentElement.tagName === "THEAD";
          cell.setAttribute("role", head && cell.textContent ? "columnheader" : cell.tagName === "TH" ? "rowheader" : "cell");
          if (!head && k) cell.dataset.head = names[k];
        });
      });
      table.classList.add("lab-cards");
    });
  };
  var stop = function (e) { e.tabIndex = e.scrollWidth > e.clientWidth ? 0 : -1; }; // only what scrolls is reached by Tab
  var fit = function () { fold(); document.querySelectorAll(".bd-article :is(div.math, pre, .pst-scrollable-table-container)").forEach(stop); };
  fit(); document.fonts.ready.then(fit);
  var turned;
  addEventListener("resize", function () { clearTimeout(turned); turned = setTimeout(fit, 200); });
})();
