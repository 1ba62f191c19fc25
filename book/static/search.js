// Search: shows the words around each hit without fetching pages, which a page from disk may not do, and
// marks the words on the page of a hit.  Nothing is stored: the words are in the address of the page.
(function () {
  window.SPHINX_HIGHLIGHT_ENABLED = false; // the theme's marks need storage and break formulas

  function pattern(roots) {
    var escaped = roots.map(function (r) { return r.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"); });
    return new RegExp("(?<![\\p{L}\\p{N}])(?:" + escaped.join("|") + ")[\\p{L}\\p{N}]*", "giu");
  }

  // ---- The page of results -------------------------------------------------------------------

  // The common beginning of a word and its stem: "gravit" finds gravity and gravitational.
  function rootsOf(query) {
    var stemmer = new Stemmer();
    return splitQuery(query.toLowerCase()).map(function (word) {
      var stem = stemmer.stemWord(word), k = 0;
      while (k < stem.length && stem[k] === word[k]) k++;
      return k < 3 ? word : word.slice(0, k);
    });
  }

  // The value of a part: how many of the words it has and, if that is equal, how often.
  function worth(part, roots) {
    var text = part[1] + " " + part[2];
    var kinds = roots.filter(function (root) { return pattern([root]).test(text); }).length;
    return kinds + Math.min((text.match(pattern(roots)) || []).length, 99) / 100;
  }

  // The part of a page to quote: the one that was found, otherwise the one with the highest value.
  function best(parts, place, roots) {
    var named = parts.filter(function (p) { return p[0] === place; });
    return (named.length ? named : parts).reduce(function (a, b) {
      return worth(b, roots) > worth(a, roots) ? b : a;
    });
  }

  function quoted(text, roots) {
    var hit = text.search(pattern(roots));
    var from = hit > 90 ? text.indexOf(" ", hit - 90) + 1 : 0;
    var to = from + 240 < text.length ? text.lastIndexOf(" ", from + 240) : text.length;
    var quote = document.createElement("p"), shown = text.slice(from, to), end = 0;
    quote.className = "context";
    quote.append(from ? "… " : "");
    Array.from(shown.matchAll(pattern(roots))).forEach(function (found) {
      var mark = document.createElement("mark");
      mark.textContent = found[0];
      quote.append(shown.slice(end, found.index), mark);
      end = found.index + found[0].length;
    });
    quote.append(shown.slice(end), to < text.length ? " …" : "");
    return quote;
  }

  function complete(item, roots) {
    var link = item.querySelector("a"), address = link.getAttribute("href").split("#");
    var words = "?words=" + encodeURIComponent(roots.join(" "));
    var parts = window.labTexts[address[0].replace(/\.html$/, "")];
    if (parts) {
      var part = best(parts, address[1] && decodeURIComponent(address[1]), roots);
      var quote = quoted(part[2], roots);
      if (!address[1] && part !== parts[0]) {
        var inner = document.createElement("a");
        inner.href = address[0] + words + "#" + part[0];
        inner.textContent = part[1];
        quote.prepend(inner, ": ");
      }
      item.append(quote);
    }
    link.href = address[0] + words + (address[1] ? "#" + address[1] : "");
  }

  // The number of letters that were left out, added, changed or swapped with the next one.
  function slips(a, b) {
    var rows = [Array.from({length: b.length + 1}, function (_, j) { return j; })];
    for (var i = 1; i <= a.length; i++) {
      rows.push([i]);
      for (var j = 1; j <= b.length; j++) {
        var swapped = i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1];
        rows[i].push(Math.min(
          rows[i - 1][j] + 1, rows[i][j - 1] + 1, rows[i - 1][j - 1] + (a[i - 1] !== b[j - 1]),
          swapped ? rows[i - 2][j - 2] + 1 : Infinity));
      }
    }
    return rows[a.length][b.length];
  }

  // The query with each word that the book does not have replaced by its nearest one.
  function meant(query, roots) {
    var counts = new Map();
    Object.values(window.labTexts).flat().forEach(function (part) {
      (part[2].toLowerCase().match(/\p{L}{4,}/gu) || []).forEach(function (word) {
        counts.set(word, (counts.get(word) || 0) + 1);
      });
    });
    var words = Array.from(counts.keys());
    return splitQuery(query.toLowerCase()).map(function (word, k) {
      if (word.length < 4 || words.some(function (w) { return w.startsWith(roots[k]); })) return word;
      var near = words.map(function (w) { return [slips(word, w), -counts.get(w), w]; })
        .filter(function (found) { return found[0] <= (word.length < 6 ? 1 : 2); })
        .sort(function (a, b) { return a[0] - b[0] || a[1] - b[1]; });
      return near.length ? near[0][2] : word;
    }).join(" ");
  }

  function offer(query, roots, list) {
    var other = meant(query, roots);
    if (other === splitQuery(query.toLowerCase()).join(" ")) return;
    var line = document.createElement("p"), link = document.createElement("a");
    line.setAttribute("role", "status");
    link.href = "?q=" + encodeURIComponent(other);
    link.textContent = other;
    line.append("Did you mean ", link, "?");
    list.before(line);
  }

  function results() {
    var query = new URLSearchParams(location.search).get("q") || "", roots = rootsOf(query);
    if (!roots.length) return;
    var texts = document.createElement("script");
    texts.src = "searchtexts.js";
    texts.onload = function () {
      var list = document.querySelector("#search-results ul.search");
      function all() {
        list.querySelectorAll("li:not([data-complete])").forEach(function (item) {
          item.dataset.complete = "";
          complete(item, roots);
        });
      }
      new MutationObserver(all).observe(list, {childList: true});
      all();
      offer(query, roots, list);
    };
    document.head.append(texts);
  }

  // Chapters and guides come before notebooks, because they explain; notebooks come before the reference.
  function score(result) {
    var page = result[0];
    if (page === "reference") return result[4];
    return result[4] + (page.startsWith("generated/") ? 10 : 30);
  }

  // ---- The page that a hit leads to ------------------------------------------------------------

  function marks() {
    var words = new URLSearchParams(location.search).get("words");
    var article = document.querySelector("article.bd-article");
    if (!words || !article || !window.Highlight) return;
    var found = ranges(article, pattern(words.split(" ")));
    if (!found.length) return;
    CSS.highlights.set("lab-found", new Highlight(...found));
    found.forEach(function (range) {
      var fold = range.startContainer.parentElement.closest("details:not([open])");
      if (fold) fold.open = true;
    });
    offerToHide(found.length, article);
    var place = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    var first = found.find(function (range) {
      return !place || place.contains(range.startContainer) ||
        place.compareDocumentPosition(range.startContainer) & Node.DOCUMENT_POSITION_FOLLOWING;
    });
    window.addEventListener("load", function () {
      var box = (first || found[0]).getBoundingClientRect();
      if (box.top < 0 || box.bottom > innerHeight) scrollBy(0, box.top - innerHeight / 3);
    });
  }

  function ranges(article, wanted) {
    var walk = document.createTreeWalker(article, NodeFilter.SHOW_TEXT), found = [], node;
    while ((node = walk.nextNode())) {
      if (node.parentElement.closest("script, style, svg, .math, .lk-embed, .lab-quiz")) continue;
      for (var hit of node.data.matchAll(wanted)) {
        var range = new Range();
        range.setStart(node, hit.index);
        range.setEnd(node, hit.index + hit[0].length);
        found.push(range);
      }
    }
    return found;
  }

  function offerToHide(count, article) {
    var button = document.createElement("button");
    button.type = "button";
    button.className = "lab-unmark";
    button.textContent = "Hide " + (count === 1 ? "the mark" : count + " marks") + " (Esc)";
    function hide() {
      CSS.highlights.delete("lab-found");
      button.remove();
      document.removeEventListener("keydown", onKey);
    }
    function onKey(event) { if (event.key === "Escape") hide(); }
    button.addEventListener("click", hide);
    document.addEventListener("keydown", onKey);
    article.append(button);
  }

  if (!document.getElementById("search-results")) marks();
  else {
    Scorer.score = score;
    document.addEventListener("DOMContentLoaded", results); // after the theme's own script, which makes the list
  }
})();
