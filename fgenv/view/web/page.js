// Additions to the player of viser: marks of collisions on its time line, steps by keys, a heading.
(() => {
  const { title, seconds, dt, contacts } = window.FGENV;

  // Stay before the end: the player starts over there.
  const inside = (t) => Math.min(Math.max(t, 0), seconds - 1e-3);
  const bar = () => document.querySelector('[role="slider"]')?.closest(".mantine-Slider-root");
  const now = () => Number(document.querySelector('[role="slider"]').getAttribute("aria-valuenow"));

  // Properties of the React component of the slider; its onChange moves the player.
  function slider() {
    const thumb = document.querySelector('[role="slider"]');
    let at = thumb[Object.keys(thumb).find((key) => key.startsWith("__reactFiber$"))];
    const isSlider = (props) => typeof props?.onChange === "function" && "max" in props;
    while (at && !isSlider(at.memoizedProps)) at = at.return;
    return at.memoizedProps;
  }

  const seek = (t) => slider().onChange(inside(t));

  function mark(track, { begin, end, text, color, shown }) {
    const it = document.createElement("div");
    it.className = "fgenv-mark";
    it.title = `${begin.toFixed(2)} s: ${text}`;
    it.style.left = `${(100 * begin) / seconds}%`;
    it.style.background = color;
    const strip = document.createElement("div");
    strip.className = "fgenv-strip";
    strip.style.left = it.style.left;
    strip.style.width = `${(100 * (end - begin)) / seconds}%`;
    strip.style.background = color;
    track.appendChild(strip);
    for (const kind of ["mousedown", "touchstart", "pointerdown"])
      it.addEventListener(kind, (event) => event.stopPropagation());
    it.addEventListener("click", () => seek(shown + 1e-6));
    track.appendChild(it);
  }

  function head() {
    const it = document.createElement("div");
    it.id = "fgenv-head";
    const count = contacts.length;
    const events = count === 0 ? "no contact events" : count === 1 ? "1 contact event" : `${count} contact events`;
    it.innerHTML = "<b></b><div></div><div></div>";
    it.children[0].textContent = title;
    it.children[1].textContent = `${seconds.toFixed(1)} s, ${events}`;
    it.children[2].textContent =
      "Space: play; ← →: a step" + (count ? "; N, P: next, previous contact event" : "");
    document.body.appendChild(it);
  }

  function key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !bar()) return;
    if (event.target.closest?.("input, textarea, select")) return;
    const t = now();
    const near = 1e-3 + dt / 20;
    const jumps = {
      ArrowRight: () => t + dt,
      ArrowLeft: () => t - dt,
      Home: () => 0,
      n: () => contacts.find((m) => m.shown > t + near)?.shown + 1e-6,
      p: () => contacts.findLast((m) => m.shown < t - near)?.shown + 1e-6,
    };
    const to = jumps[event.key]?.();
    if (to === undefined || Number.isNaN(to)) return;
    event.preventDefault();
    event.stopPropagation();
    seek(to);
  }

  const style = document.createElement("style");
  style.textContent = `
    #fgenv-head { position: fixed; right: 14px; top: 12px; z-index: 2; pointer-events: none;
      font: 13px/1.45 system-ui, sans-serif; color: #26303a; background: #ffffffc8;
      padding: 6px 10px; border-radius: 6px; }
    #fgenv-head div:last-child { color: #5b6670; font-size: 12px; }
    .fgenv-mark { position: absolute; top: -8px; height: 18px; width: 6px; z-index: 3;
      margin-left: -3px; border-radius: 2px; cursor: pointer; border: 1px solid #0008;
      box-sizing: border-box; }
    .fgenv-strip { position: absolute; top: 11px; height: 3px; opacity: 0.6; }
    .fgenv-mark:hover { outline: 2px solid #26303a; }`;
  document.head.appendChild(style);
  head();
  window.addEventListener("keydown", key, true);
  // The player appears once the scene is unpacked, and can be rebuilt.
  setInterval(() => {
    const track = bar()?.querySelector(".mantine-Slider-track");
    if (!track || track.querySelector(".fgenv-mark") || contacts.length === 0) return;
    track.style.position = "relative";
    contacts.forEach((contact) => mark(track, contact));
  }, 200);
})();
