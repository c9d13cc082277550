// Reorders the rows of a list by dragging their handles, or with the arrow keys on them.

const EDGE = 32; // pixels from the ends of a list, within which dragging scrolls it
const SCROLL = 8; // pixels per frame

/**
 * @param list the element; it scrolls if it is too high
 * @param rows returns the visible rows, from top to bottom: elements with a handle
 * @param on_move called with two of these rows: the first is to be moved to the position of the second
 */
export function make_movable(list, rows, on_move) {
  list.addEventListener("keydown", (event) => {
    const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    const row = row_at(event.target);
    if (!step || !row) return;
    event.preventDefault();
    const seen = rows();
    const other = seen[seen.indexOf(row) + step];
    if (other) on_move(row, other);
    event.target.focus();
  });
  list.addEventListener("pointerdown", (event) => {
    const row = row_at(event.target);
    if (!row || event.button !== 0) return;
    event.preventDefault(); // prevents text selection
    event.target.focus();
    drag(list, row, rows(), event, on_move);
  });
}

function row_at(target) {
  return target.classList.contains("handle") ? target.closest("li") : null;
}

function drag(list, row, rows, { target, pointerId, clientY }, on_move) {
  const from = rows.indexOf(row);
  let to = from;
  let y = clientY;
  let frame = 0;
  const show = () => {
    to = position_of(rows, y, from);
    rows.forEach((other, i) => {
      other.classList.toggle("drop-above", i === to && to < from);
      other.classList.toggle("drop-below", i === to && to > from);
    });
  };
  const scroll = () => {
    const { top, bottom } = list.getBoundingClientRect();
    if (y < top + EDGE) list.scrollTop -= SCROLL;
    if (y > bottom - EDGE) list.scrollTop += SCROLL;
    show();
    frame = requestAnimationFrame(scroll);
  };
  const move = (event) => (y = event.clientY);
  const end = ({ type, clientY: last_y }) => {
    cancelAnimationFrame(frame);
    // There may have been no frame since the pointer moved.
    if (type === "pointerup") to = position_of(rows, last_y, from);
    row.classList.remove("dragged");
    for (const other of rows) other.classList.remove("drop-above", "drop-below");
    for (const name of ["pointermove", "pointerup", "pointercancel"]) {
      target.removeEventListener(name, name === "pointermove" ? move : end);
    }
    if (type === "pointerup" && to !== from) on_move(row, rows[to]);
    target.focus();
  };
  target.setPointerCapture(pointerId);
  target.addEventListener("pointermove", move);
  target.addEventListener("pointerup", end);
  target.addEventListener("pointercancel", end);
  row.classList.add("dragged");
  frame = requestAnimationFrame(scroll);
}

/** The position among the rows for a row from position `from` that is dropped at height `y`. */
function position_of(rows, y, from) {
  const middles = rows.map((row) => {
    const { top, height } = row.getBoundingClientRect();
    return top + height / 2;
  });
  return middles.filter((middle, i) => i !== from && middle < y).length;
}
