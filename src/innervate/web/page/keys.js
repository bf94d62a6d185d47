// Keys for the whole page, and the list of them.

const $ = (id) => document.getElementById(id);
const ON_MAP = [
  ["Tab", "to the map and every control"],
  ["← → ↑ ↓", "on the map: to the next node that way"],
  ["Shift + arrow", "on the map: to the link that way"],
  ["Enter", "on the map: cut or heal the link, kill or revive the node", "act"],
  ["Esc", "on the map: select nothing"],
];

const lines = []; // [what a key needs, its two elements]

/** List those keys only that do something here, by what is {offered}. */
export function showKeys(offered) {
  for (const [need, ...parts] of lines) {
    for (const part of parts) part.hidden = Boolean(need) && !offered.has(need);
  }
}

/**
 * @param {[string, string, string, Function, string?][]} keys each with its name, meaning, deed,
 *   and what it needs to do something
 */
export function setUpKeys(keys) {
  const help = $("help");
  const open = () => help.showModal();
  const all = [...keys, ["?", "?", "these keys", open]];
  const named = all.map(([, name, meaning, , need]) => [name, meaning, need]);
  for (const [name, meaning, need] of [...ON_MAP, ...named]) {
    const term = document.createElement("dt");
    const text = document.createElement("dd");
    term.textContent = name;
    text.textContent = meaning;
    $("keys").append(term, text);
    lines.push([need, term, text]);
  }
  $("help-open").addEventListener("click", open);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || help.open) return;
    const { target, key } = event;
    const typing = target.matches("input, select, dialog *");
    const pressing = key === " " && target.matches("button, a");
    const found = all.find(([one]) => one === key);
    if (typing || pressing || !found) return;
    event.preventDefault();
    found[3]();
  });
}
