// What pointer, wheel and fingers do on the picture.

/** Wheel zooms, shift and wheel or a middle button pans, a double click shows all. */
export function listen(plot, plots) {
  const { over } = plot;
  over.addEventListener("wheel", (event) => {
    event.preventDefault();
    const sideways = event.shiftKey ? event.deltaY : event.deltaX;
    if (Math.abs(sideways) > Math.abs(event.shiftKey ? 0 : event.deltaY)) return plots.pan(sideways / 1000);
    const at = plot.posToVal(event.clientX - over.getBoundingClientRect().left, "x");
    plots.zoom(event.deltaY < 0 ? 0.8 : 1.25, at);
  }, { passive: false });
  over.addEventListener("dblclick", () => plots.show(...plots.full));
  over.addEventListener("mousedown", () => (plots.hasDragged = false));
  over.addEventListener("click", () => plots.hasDragged || plots.setMark());
  let from;
  const touches = new Map();
  over.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "touch") touches.set(event.pointerId, event.clientX);
    else if (event.button === 1) {
      from = event.clientX;
      over.setPointerCapture(event.pointerId);
      event.preventDefault();
    }
  });
  over.addEventListener("pointermove", (event) => {
    if (touches.size === 1 && touches.has(event.pointerId)) {
      plots.pan((touches.get(event.pointerId) - event.clientX) / over.clientWidth);
    } else if (touches.size === 2 && touches.has(event.pointerId)) {
      const [a, b] = touches.values();
      const other = [...touches].find(([id]) => id !== event.pointerId)[1];
      const before = Math.abs(a - b), now = Math.abs(event.clientX - other);
      if (now > 8) plots.zoom(before / now);
    } else if (from !== undefined) {
      plots.pan((from - event.clientX) / over.clientWidth);
      from = event.clientX;
    }
    if (touches.has(event.pointerId)) touches.set(event.pointerId, event.clientX);
  });
  const end = (event) => {
    touches.delete(event.pointerId);
    from = undefined;
  };
  over.addEventListener("pointerup", end);
  over.addEventListener("pointercancel", end);
}
