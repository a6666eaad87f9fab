// the samples as a table, and what is shown as a picture, saved by the browser

function save(blob, name) {
  const link = document.createElement("a");
  link.setAttribute("href", URL.createObjectURL(blob));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.getAttribute("href")), 10_000);
}

function fileName(title) {
  return title.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_|_$/g, "") || "motion";
}

function saveSamples(samples, { title, start }) {
  save(new Blob([samples.asCsv(start)], { type: "text/csv" }), fileName(title) + ".csv");
}

function savePicture(viewer, { title, start }, time) {
  viewer.render(); // what was drawn before is gone by now
  const name = `${fileName(title)}_${(start + time).toFixed(3)}s.png`;
  viewer.renderer.domElement.toBlob((blob) => save(blob, name), "image/png");
}
