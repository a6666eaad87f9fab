"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  // both playbacks share one viewer
  for (const stage of document.querySelectorAll("[data-play]")) {
    const [before, after] = data.pages[stage.dataset.play];
    const frame = document.createElement("iframe");
    frame.title = stage.closest("article").querySelector("h3").textContent;
    frame.srcdoc = before + data.viewer + after;
    stage.replaceChildren(frame);
  }
})();
