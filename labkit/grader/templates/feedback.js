// In a feedback page with replays, build each one when it is about to be seen.
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const dress = () => { document.documentElement.dataset.theme = dark.matches ? "dark" : "light"; };
  dress();
  dark.addEventListener("change", dress);
  const show = (host) => {
    const place = document.createElement("div");
    host.insertBefore(place, host.querySelector("figcaption"));
    host.dataset.mounted = "1";
    try {
      const data = host.querySelector('script[type="application/json"]').textContent;
      labkitViewer.mount(place, JSON.parse(data));
      if (place.querySelector(".lk-note")) host.classList.add("lk-flat"); // no WebGL: the words stay
    } catch (problem) {
      delete host.dataset.mounted;
      place.remove();
      console.error(problem);
    }
  };
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      show(target);
    }
  }, { rootMargin: "400px" });
  for (const host of document.querySelectorAll(".lk-embed")) near.observe(host);
})();
