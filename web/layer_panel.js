// The list of layers: on or off, colour and opacity of each.

/**
 * One row of the list for `layer`. `state` is {is_on, style: {fill, opacity}}; `on_change` is
 * called with such an object whenever the user changes something. Returns the element and a
 * function that shows another state.
 */
export function layer_row(layer, state, on_change) {
  const title = String(layer.title || layer.name);
  const is_on = input("checkbox", {});
  const fill = input("color", { "aria-label": `Colour of ${title}` });
  const opacity = input("range", { min: 0, max: 1, step: 0.05, "aria-label": `Opacity of ${title}` });
  const percent = document.createElement("output");

  const show = (shown) => {
    is_on.checked = shown.is_on;
    fill.value = `#${shown.style.fill}`;
    opacity.value = shown.style.opacity;
    percent.textContent = `${Math.round(100 * shown.style.opacity)}%`;
  };
  const read = () => ({
    is_on: is_on.checked,
    style: { fill: fill.value.slice(1).toLowerCase(), opacity: Number(opacity.value) },
  });
  show(state);

  // A slider or colour being dragged tells its number at once; the map follows on release, since
  // every step of it would be a screen full of new tiles.
  opacity.addEventListener("input", () => {
    percent.textContent = `${Math.round(100 * opacity.value)}%`;
  });
  for (const control of [is_on, fill, opacity]) {
    control.addEventListener("change", () => on_change(read()));
  }

  const row = document.createElement("li");
  row.title = String(layer.description ?? "");
  row.append(
    element("label", "name", is_on, element("span", "", title)),
    fill,
    element("label", "opacity", "Opacity", opacity, percent),
  );
  return { row, show };
}

function input(type, attributes) {
  const control = document.createElement("input");
  control.type = type;
  for (const [name, value] of Object.entries(attributes)) control.setAttribute(name, value);
  return control;
}

function element(tag, class_name, ...children) {
  const made = document.createElement(tag);
  if (class_name) made.className = class_name;
  made.append(...children);
  return made;
}
