// questions to the server; while an answer is awaited only the latest wish is kept

const AGAIN = 1000; // ms until a question is repeated that the server has no time for

// `heard(answer, wish, latest)` and `refused(text, wish)` give the next wish, if one follows, or true of what is shown
function makeAsking({ kind, client }, { heard, refused, lost }) {
  const own = crypto.randomUUID();
  const get = (path) => fetch(path, { headers: { [client]: own } });
  const timings = []; // of what was shown, in ms
  let wish = null;
  let asking = null;

  function ask(search, options = {}) {
    wish = { search, ...options, begun: performance.now() };
    asking = asking || answerWishes().finally(() => (asking = null));
    return asking;
  }

  async function answerWishes() {
    document.body.classList.add("busy");
    while (wish) {
      const present = wish;
      wish = null;
      try {
        await answer(present);
      } catch (problem) {
        lost();
      }
    }
    document.body.classList.remove("busy");
  }

  async function answer(present) {
    const { search, begun } = present;
    const sent = performance.now();
    const response = await get("/" + kind + search);
    const said = await response.json();
    const received = performance.now();
    if (response.status === 409) return; // it has something newer to compute for this page
    if (response.status === 503) { // it has too much to compute
      await new Promise((done) => setTimeout(done, AGAIN));
      wish = wish || present;
      return;
    }
    const next = response.ok ? heard(said, present, !wish) : refused(said.error, present);
    if (next !== true) {
      wish = wish || (next ? { ...next, begun } : null);
      return;
    }
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    const server = (response.headers.get("Server-Timing") || "").matchAll(/(\w+);dur=([\d.]+)/g);
    timings.push({ search, waited: sent - begun, answered: received - sent, rendered: performance.now() - received,
      total: performance.now() - begun, ...Object.fromEntries([...server].map(([, name, ms]) => [name, Number(ms)])) });
  }

  return { ask, get, timings, idle: () => asking };
}
