(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const at = (id) => document.getElementById(id);
  const COLORS = new Map([["stance", "#2f5fa8"], ["flight", "#7b96ad"], ["posterior stance", "#2f5fa8"],
    ["anterior stance", "#2a8c86"], ["flight 1", "#7b96ad"], ["flight 2", "#93a3b5"],
    ["double stance 1", "#6d5bb0"], ["double stance 2", "#6d5bb0"]]);
  const SLIPPING = "#c2873a";
  const OTHERS = ["#2a8c86", "#6d5bb0", "#a65f94", "#5c7f4c", "#8a5a40"];
  let named = 0;

  function colorOf(name) {
    if (!COLORS.has(name)) COLORS.set(name, name.includes("slip") ? SLIPPING : OTHERS[named++ % OTHERS.length]);
    return COLORS.get(name);
  }

  const viewer = openViewer(at("pane"), data.commands, data);

  function fit() {
    viewer.camera.zoom = Math.min(1, innerWidth / innerHeight / data.aspect);
    viewer.set_dirty();
  }
  addEventListener("resize", fit);
  fit();

  const player = { viewer, time: 0, speed: 1, playing: false };

  player.seek = function (time) {
    player.time = Math.max(0, Math.min(data.duration, time));
    viewer.animator.seek(player.time);
    const span = data.spans.filter((span) => span[1] <= player.time).pop() || data.spans[0];
    at("domain").textContent = span[0];
    at("domain").style.background = colorOf(span[0]);
    at("time").textContent = (data.start + player.time).toFixed(3) + " s";
    at("scrubber").value = player.time;
  };

  player.setPlaying = function (playing) {
    player.playing = playing;
    at("play").classList.toggle("playing", playing);
    at("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  };

  player.setSpeed = function (speed) {
    player.speed = speed;
    for (const button of at("speeds").children) button.setAttribute("aria-pressed", Number(button.value) === speed);
  };

  function buildBar() {
    const percent = (time) => (100 * time) / data.duration + "%";
    const stops = data.spans.map(([name, begin, end]) => `${colorOf(name)} ${percent(begin)} ${percent(end)}`);
    at("spans").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
    for (const [name, time] of data.events) {
      const tick = document.createElement("i");
      tick.style.left = percent(time);
      tick.title = name;
      at("spans").append(tick);
    }
    at("scrubber").max = data.duration;
    at("scrubber").addEventListener("input", () => {
      player.setPlaying(false);
      player.seek(Number(at("scrubber").value));
    });
    at("play").addEventListener("click", () => player.setPlaying(!player.playing));
    for (const speed of data.speeds) {
      const button = document.createElement("button");
      button.type = "button";
      button.value = speed;
      button.textContent = speed + "×";
      button.addEventListener("click", () => player.setSpeed(speed));
      at("speeds").append(button);
    }
  }

  function buildLegend() {
    for (const [text, color] of data.legend) {
      const item = document.createElement("li");
      const swatch = document.createElement("i");
      swatch.style.background = color;
      item.append(swatch, text);
      at("legend").append(item);
    }
    for (const note of data.notes) {
      const item = document.createElement("li");
      item.textContent = note;
      at("notes").append(item);
    }
  }

  function startFromAddress() {
    const wanted = /[#&]t=([-+.\deE]+)/.exec(location.hash);
    const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
    player.setPlaying(!wanted && !calm);
    player.seek(wanted ? Number(wanted[1]) - data.start : 0);
  }

  addEventListener("hashchange", startFromAddress);
  addEventListener("keydown", (event) => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (event.key === " " && event.target.tagName !== "BUTTON") player.setPlaying(!player.playing);
    else if (step) {
      player.setPlaying(false);
      player.seek(player.time + step / 120);
    } else return;
    event.preventDefault();
  });

  let last = performance.now();
  function tick(now) {
    const passed = Math.min(0.1, Math.max(0, (now - last) / 1000)) * player.speed;
    last = now;
    if (player.playing) player.seek((player.time + passed) % data.duration);
    requestAnimationFrame(tick);
  }

  buildBar();
  buildLegend();
  player.setSpeed(data.speeds[0]);
  startFromAddress();
  requestAnimationFrame(tick);
  window.player = player;
})();
