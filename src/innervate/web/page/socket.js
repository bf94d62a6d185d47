// The connection to the server; when it is lost the page tries again by itself.

const WAIT_MS = [250, 500, 1000, 2000];

/** Opens the websocket beside this page and keeps it open. */
export class Connection {
  /**
   * @param {(message: object) => void} onMessage for every message of the server
   * @param {(open: boolean, tries: number) => void} onChange when the connection comes or goes
   */
  constructor(onMessage, onChange) {
    this.onMessage = onMessage;
    this.onChange = onChange;
    this.tries = 0;
    this.#open();
  }

  /** Send a command; false where there is no connection. */
  send(command) {
    if (this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(command));
    return true;
  }

  #open() {
    const address = new URL("socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    address.search = "";
    const token = new URLSearchParams(location.search).get("token");
    if (token) address.searchParams.set("token", token);
    this.socket = new WebSocket(address);
    this.socket.addEventListener("open", () => {
      this.tries = 0;
      this.onChange(true, 0);
    });
    this.socket.addEventListener("message", (event) => this.onMessage(JSON.parse(event.data)));
    this.socket.addEventListener("close", () => {
      this.onChange(false, this.tries);
      const wait = WAIT_MS[Math.min(this.tries, WAIT_MS.length - 1)];
      this.tries += 1;
      setTimeout(() => this.#open(), wait);
    });
  }
}
