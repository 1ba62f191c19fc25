// Quizzes, the film's captions, the choice in galleries, tables on phones, and open details in print.  Nothing is stored or sent.
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

  // The film's captions come from the list below it, because a page from disk may not fetch a file of captions.
  document.querySelectorAll(".lab-film").forEach(function (film) {
    var track = film.querySelector("video").addTextTrack("captions", "English", "en");
    film.querySelectorAll("[data-until]").forEach(function (line) {
      track.addCue(new VTTCue(+line.dataset.from, +line.dataset.until, line.textContent));
    });
    track.mode = "showing";
  });

  // A gallery shows one method at a time, which an address such as #joint-torque chooses. On paper all are shown.
  var runs = Array.prototype.map.call(document.querySelectorAll(".lab-one"), function (p) { return p.closest("section"); });
  if (runs.length) {
    var choice = document.createElement("select");
    choice.id = "lab-method";
    runs.forEach(function (run) { choice.add(new Option(run.querySelector("h2").firstChild.textContent, run.id)); });
    var label = document.createElement("label");
    label.htmlFor = choice.id;
    label.textContent = "Method ";
    var picker = document.createElement("p");
    picker.className = "lab-picker";
    picker.append(label, choice);
    runs[0].before(picker);
    var choose = function () {
      var wanted = location.hash.slice(1);
      var known = runs.some(function (run) { return run.id === wanted; });
      if (known) choice.value = wanted;
      runs.forEach(function (run) { run.classList.toggle("lab-other", run.id !== choice.value); });
      if (known) document.getElementById(wanted).scrollIntoView();
    };
    choice.addEventListener("change", function () { history.replaceState(null, "", "#" + choice.value); choose(); });
    addEventListener("hashchange", choose);
    choose();
  }

  // On a phone, a table that is too wide becomes a card for each row; for screen readers its roles keep it a table.
  var heads = function (table) { return Array.prototype.map.call(table.querySelectorAll("thead th, thead td"), function (h) { return h.textContent; }); };
  var fold = function () {
    document.querySelectorAll(".bd-article table:not(.indextable)").forEach(function (table) {
      table.classList.remove("lab-cards");
      var names = heads(table), box = table.parentElement;
      if (innerWidth > 700 || !names.length || box.scrollWidth <= box.clientWidth + 1) return;
      table.setAttribute("role", "table");
      table.querySelectorAll("thead, tbody").forEach(function (e) { e.setAttribute("role", "rowgroup"); });
      table.querySelectorAll("tr").forEach(function (row) {
        row.setAttribute("role", "row");
        Array.prototype.forEach.call(row.cells, function (cell, k) {
          var head = row.parentElement.tagName === "THEAD";
          cell.setAttribute("role", head ? "columnheader" : cell.tagName === "TH" ? "rowheader" : "cell");
          if (!head && k) cell.dataset.head = names[k];
        });
      });
      table.classList.add("lab-cards");
    });
  };
  fold();
  var turned;
  addEventListener("resize", function () { clearTimeout(turned); turned = setTimeout(fold, 200); });
})();
