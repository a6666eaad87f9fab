"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const all = (selector, within) => [...(within || document).querySelectorAll(selector)];

  // a playback is put together from the viewer, which all share, when it is asked for
  for (const stage of all("[data-play]"))
    stage.querySelector("button").addEventListener("click", () => {
      const [before, after] = data.pages[stage.dataset.play];
      const frame = document.createElement("iframe");
      frame.title = stage.closest("article").querySelector("h3").textContent;
      frame.srcdoc = before + data.viewer + after;
      stage.replaceChildren(frame);
    });

  const buttons = all(".filter button");
  function show(kind) {
    for (const button of buttons) button.setAttribute("aria-pressed", button.value === kind);
    for (const row of all("tr[data-verdict]")) row.hidden = kind !== "" && row.dataset.verdict !== kind;
    for (const card of all("section[id^=chapter] .card"))
      card.hidden = kind !== "" && !all("tr[data-verdict]", card).some((row) => !row.hidden);
    for (const section of all("section[id^=chapter]"))
      section.hidden = all(".card", section).every((card) => card.hidden);
  }
  for (const button of buttons) button.addEventListener("click", () => show(button.value));

  // a link leads to its row even where that is filtered out
  addEventListener("hashchange", () => {
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (target && target.closest("[hidden]")) {
      show("");
      target.scrollIntoView();
    }
  });

  const links = new Map(all("nav li a").map((link) => [link.hash.slice(1), link]));
  const seen = new IntersectionObserver(
    (entries) => {
      for (const entry of entries)
        if (entry.isIntersecting) {
          for (const link of links.values()) link.removeAttribute("aria-current");
          const link = links.get(entry.target.id);
          link.setAttribute("aria-current", "true");
        }
    },
    { rootMargin: "-10% 0px -80% 0px" }
  );
  for (const name of links.keys()) seen.observe(document.getElementById(name));
})();
