// Opens drawings that are small on a phone at a readable size over the page, where they can be moved and zoomed.
(function () {
  var dialog, gap, drawing;

  function open(figure) {
    drawing = figure.querySelector(".lab-svg, img");
    var box = drawing.getBoundingClientRect();
    gap = document.createElement("div");
    gap.style.height = box.height + "px";
    dialog = document.createElement("dialog");
    dialog.className = "lab-large";
    dialog.setAttribute("aria-label", "The drawing, enlarged");
    dialog.innerHTML = '<form method="dialog"><p>Move it sideways, or turn the phone.</p>' +
      '<button class="lab-close">Close</button></form><div class="lab-sheet" tabindex="0"></div>';
    dialog.style.setProperty("--shape", box.width / box.height);
    dialog.addEventListener("close", close);
    figure.after(dialog);
    drawing.replaceWith(gap);
    dialog.lastChild.append(drawing);
    dialog.showModal();
  }

  function close() {
    gap.replaceWith(drawing);
    dialog.remove();
  }

  document.addEventListener("DOMContentLoaded", function () {
    document.querySelectorAll(".lab-figure:not(:has(video)) figcaption").forEach(function (caption) {
      var button = document.createElement("button");
      button.type = "button";
      button.className = "lab-enlarge";
      button.textContent = "Enlarge";
      button.setAttribute("aria-haspopup", "dialog");
      caption.prepend(button);
    });
  });
  document.addEventListener("click", function (event) {
    var figure = event.target.closest && event.target.closest(".lab-enlarge, .lab-figure > .lab-svg, .lab-figure > img");
    figure = figure && figure.closest(".lab-figure");
    var button = figure && figure.querySelector(".lab-enlarge");
    if (button && button.checkVisibility()) open(figure); // on a wide screen the drawing is large already
  });
})();
