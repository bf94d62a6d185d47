// Keys for the whole page, and the list of them.

const $ = (id) => document.getElementById(id);
const ON_MAP = [
  ["Tab", "to the map and every control"],
  ["← → ↑ ↓", "on the map: to the next node that way"],
  ["Shift + arrow", "on the map: to the link that way"],
  ["Enter", "on the map: cut or heal the link, kill or revive the node"],
  ["Esc", "on the map: select nothing"],
];

/** @param {[string, string, string, Function][]} keys each with its name, meaning and deed */
export function setUpKeys(keys) {
  const help = $("help");
  const open = () => help.showModal();
  const all = [...keys, ["?", "?", "these keys", open]];
  for (const [name, meaning] of [...ON_MAP, ...all.map((one) => one.slice(1))]) {
    const term = document.createElement("dt");
    const text = document.createElement("dd");
    term.textContent = name;
    text.textContent = meaning;
    $("keys").append(term, text);
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
