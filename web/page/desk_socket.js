// The connection to a running session: opens it again when it is lost.

const kFirstWait = 500, kLongestWait = 5000; // ms
const kRunEnded = 1001; // the close code with which a run ends in order

export class DeskSocket {
  #url;
  #on;
  #socket = null;
  #wait = kFirstWait;
  #want = [];

  /** @param {string} url  ws://..., @param on  line(object), bytes(ArrayBuffer), state('connecting' | 'connected' | 'lost' | 'ended') */
  constructor(url, on) {
    [this.#url, this.#on] = [url, on];
    this.#open();
  }

  /** @param {('picture' | 'skin')[]} words  what is sent beside lines */
  want(words) {
    this.#want = words;
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify({ want: words }));
  }

  drop() { this.#socket.close(); }

  #open() {
    this.#on.state('connecting');
    const socket = this.#socket = new WebSocket(this.#url);
    socket.binaryType = 'arraybuffer';
    socket.addEventListener('open', () => {
      this.#wait = kFirstWait;
      this.#on.state('connected');
      this.want(this.#want);
    });
    socket.addEventListener('message', ({ data }) => {
      if (typeof data === 'string') this.#on.line(JSON.parse(data));
      else this.#on.bytes(data);
    });
    socket.addEventListener('close', ({ code }) => {
      if (code === kRunEnded) return this.#on.state('ended');
      this.#on.state('lost');
      setTimeout(() => this.#open(), this.#wait);
      this.#wait = Math.min(2 * this.#wait, kLongestWait);
    });
  }
}
