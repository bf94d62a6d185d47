// The connection to the server; when it is lost the page tries again by itself.
import { apart } from "./words.js";

const REFUSED = 4403; // close code: not the token of this server
const WAIT_MS = [250, 500, 1000, 2000];

/** What this page was opened with: who has it may look on and command. */
export const TOKEN = new URLSearchParams(location.search).get("token") ?? "";

/** Opens the websocket beside this page and keeps it open. */
export class Connection {
  /**
   * @param {(message: object) => void} onMessage for every message of the server
   * @param {(open: boolean, refused: boolean) => void} onChange when the connection comes or goes
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
    address.searchParams.set("token", TOKEN);
    this.socket = new WebSocket(address);
    this.socket.addEventListener("open", () => {
      this.onChange(true, false);
    });
    this.socket.addEventListener("message", (event) => {
      this.tries = 0;
      this.onMessage(JSON.parse(apart(event.data)));
    });
    this.socket.addEventListener("close", ({ code }) => {
      this.onChange(false, code === REFUSED);
      const wait = WAIT_MS[Math.min(this.tries, WAIT_MS.length - 1)];
      this.tries += 1;
      setTimeout(() => this.#open(), wait);
    });
  }
}
