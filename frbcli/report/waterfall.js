// Reads time, speed, frequency and amplitude of the waterfall out under the pointer; + and - by the arrow keys.
(() => {
  const source = document.getElementById("levels");
  if (!source) return;
  const data = JSON.parse(source.textContent);
  const level = Uint8Array.from(atob(data.levels), (letter) => letter.charCodeAt(0));
  const [left, top, width, height] = data.box;
  const columns = data.times.length, rows = data.frequencies.length;
  const sense = document.getElementById("sense"), pointer = document.getElementById("pointer");
  const reading = document.getElementById("reading"), svg = sense.ownerSVGElement;
  let column = 0, row = 0;

  const digits = (value, count) => Number(value.toPrecision(count)).toString();

  const show = () => {
    const x = left + width * (column + 0.5) / columns, y = top + height * (1 - (row + 0.5) / rows);
    pointer.innerHTML = `<path d="M${x},${top}V${top + height}M${left},${y}H${left + width}"/>`;
    const decibel = data.lowest + data.step * level[row * columns + column];
    const amplitude = data.clearance * Math.pow(10, decibel / 20), speed = Math.abs(data.speeds[column]);
    const frequency = data.frequencies[row];
    const order = speed > 0 ? ` (${digits(frequency / speed, 3)}X)` : "";
    reading.textContent =
      `time ${digits(data.times[column], 4)} s, rotor ${digits(speed, 4)} Hz, frequency ${digits(frequency, 4)} Hz` +
      `${order}, amplitude ${digits(1e6 * amplitude, 3)} µm, ${digits(decibel, 3)} dB`;
  };

  const clip = (value, count) => Math.min(Math.max(value, 0), count - 1);
  const move = (event) => {
    const frame = sense.getBoundingClientRect();
    column = clip(Math.floor(columns * (event.clientX - frame.left) / frame.width), columns);
    row = clip(Math.floor(rows * (1 - (event.clientY - frame.top) / frame.height)), rows);
    show();
  };
  sense.addEventListener("pointermove", move);
  sense.addEventListener("pointerdown", (event) => { move(event); svg.focus(); });
  svg.setAttribute("tabindex", "0");
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!step) return;
    column = clip(column + step[0], columns);
    row = clip(row + step[1], rows);
    show();
    event.preventDefault();
  });
  const folded = () => document.querySelectorAll("details");
  addEventListener("beforeprint", () => folded().forEach((each) => { each.dataset.open = each.open; each.open = true; }));
  addEventListener("afterprint", () => folded().forEach((each) => { each.open = each.dataset.open === "true"; }));
})();
