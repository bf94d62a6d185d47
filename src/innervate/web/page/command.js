// Commands of a skin's PC: to the cell that is selected, or by the PC's own port to all.

const $ = (id) => document.getElementById(id);

/** The part of the card that sends commands. */
export class CommandBox {
  /** @param {(command: object) => void} send */
  constructor(send) {
    $("command-send").addEventListener("click", () => {
      const [code, value] = ["command-code", "command-value"].map((id) => $(id));
      if (![code, value].every((input) => input.reportValidity())) return;
      send({ do: "command", ...this.target, code: code.valueAsNumber, value: value.valueAsNumber });
    });
  }

  /** Show it for {node} of a network, where commands can be sent. */
  show(network, what) {
    const node = what?.node === undefined ? null : network.nodes[what.node];
    const isOpen = Boolean(node) && network.can.has("command");
    $("command").hidden = !isOpen;
    if (!isOpen) return;
    const toAll = node.role !== "cell";
    this.target = toAll ? {} : { node: node.id };
    const text = toAll ? "Send to all cells" : "Send to this cell";
    if ($("command-send").textContent !== text) $("command-send").textContent = text;
  }
}
