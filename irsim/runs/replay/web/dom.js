// Parts of the page. Text from a run is only ever set as text.

export const $ = (id) => document.getElementById(id);

export function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

/** Put name and value pairs into a list of terms. */
export function setTerms(list, pairs) {
  while (list.children.length > 2 * pairs.length) list.lastChild.remove();
  pairs.forEach(([name, value], i) => {
    if (!list.children[2 * i]) list.append(element("dt"), element("dd"));
    const [term, told] = [list.children[2 * i], list.children[2 * i + 1]];
    if (term.textContent !== name) term.textContent = name;
    if (told.textContent !== value) told.textContent = value;
  });
}
