// Creates elements of the page without markup, so that no text from a server can become a tag.

export function element(tag, class_name, ...children) {
  const made = document.createElement(tag);
  if (class_name) made.className = class_name;
  made.append(...children);
  return made;
}

export function input(type, attributes = {}) {
  const made = document.createElement("input");
  made.type = type;
  set_attributes(made, attributes);
  return made;
}

export function button(text, attributes = {}) {
  const made = element("button", "", text);
  made.type = "button";
  set_attributes(made, attributes);
  return made;
}

/** `options`: pairs of value and text. */
export function select(options, attributes = {}) {
  const made = document.createElement("select");
  made.append(...options.map(([value, text]) => new Option(text, value)));
  set_attributes(made, attributes);
  return made;
}

/** Selects `value`, and adds it as an option if missing, because it may come from an address. */
export function choose(list, value) {
  if (![...list.options].some((option) => option.value === value)) {
    list.append(new Option(value, value));
  }
  list.value = value;
}

/** Marks the value of `control` as invalid, for people and for assistive technology. */
export function mark_wrong(control, is_wrong) {
  if (is_wrong) control.setAttribute("aria-invalid", "true");
  else control.removeAttribute("aria-invalid");
}

function set_attributes(made, attributes) {
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
}
