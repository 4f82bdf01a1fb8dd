// The module of WebAssembly: fetched and started once, and how JavaScript reads and writes its memory.

/** A call that the library refused. `status` is a palpable_status. */
export class PalpableError extends Error {
  constructor(status, message) {
    super(message);
    this.name = 'PalpableError';
    this.status = status;
  }
}

const kWasm = new URL('./dist/palpable.wasm', import.meta.url);

async function compiled(source) {
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  const url = source instanceof URL ? source : new URL(String(source), import.meta.url);
  if (url.protocol === 'file:') {
    const { readFile } = await import('node:fs/promises');
    return WebAssembly.compile(await readFile(url));
  }
  const answer = await fetch(url);
  if (!answer.ok) throw new Error(`${url}: ${answer.status} ${answer.statusText}`);
  // Compiled while it arrives, where the server names the type that browsers demand for it.
  const streams = answer.headers.get('content-type')?.startsWith('application/wasm');
  return streams ? WebAssembly.compileStreaming(answer) : WebAssembly.compile(await answer.arrayBuffer());
}

/** The exports of the module, and its memory. */
export class Core {
  #exports;
  #decoder = new TextDecoder();

  constructor(exports) {
    this.#exports = exports;
    const layout = JSON.parse(this.text(exports.palpable_layout()));
    this.structs = layout.structs;
    this.constants = layout.constants;
    this.joints = layout.joints;
  }

  /** @param source  where palpable.wasm is: URL or bytes; beside this file if left out */
  static async start(source = kWasm) {
    // What emscripten's standard library asks of its host. The core opens no file and prints nothing; what a failed
    // assertion of the library prints is thrown away, and the trap that follows is thrown by the call.
    const refuse = () => 52; // ENOSYS of WASI
    const imports = {};
    const module = await compiled(source);
    const own = {
      proc_exit: (code) => { throw new Error(`palpable.wasm ended with code ${code}`); },
      emscripten_notify_memory_growth: () => {},
    };
    for (const { module: group, name, kind } of WebAssembly.Module.imports(module)) {
      if (kind === 'function') (imports[group] ??= {})[name] = own[name] ?? refuse;
    }
    const instance = await WebAssembly.instantiate(module, imports);
    instance.exports._initialize?.();
    return new Core(instance.exports);
  }

  get exports() { return this.#exports; }
  get memory() { return this.#exports.memory; }
  /** Bytes that the module's memory has; it never shrinks. */
  get memoryBytes() { return this.memory.buffer.byteLength; }

  // Anew in each call: when the memory grows, earlier views are cut off from it.
  get view() { return new DataView(this.memory.buffer); }
  floats(at, count) { return new Float32Array(this.memory.buffer, at, count); }
  ints(at, count) { return new Int32Array(this.memory.buffer, at, count); }
  doubles(at, count) { return new Float64Array(this.memory.buffer, at, count); }
  bytes(at, count) { return new Uint8Array(this.memory.buffer, at, count); }

  text(at) {
    const all = new Uint8Array(this.memory.buffer);
    return this.#decoder.decode(all.slice(at, all.indexOf(0, at)));
  }

  allocate(bytes) {
    const at = this.#exports.malloc(bytes);
    if (at === 0) throw new PalpableError(4, `out of memory: ${bytes} bytes`);
    return at;
  }
  free(at) { this.#exports.free(at); }

  /** Calls a function that returns a palpable_status. @throws PalpableError */
  call(name, ...values) {
    const status = this.#exports[name](...values);
    if (status !== 0) throw new PalpableError(status, this.text(this.#exports.palpable_last_error()));
  }

  /** Space for a struct, its size set. */
  struct(name) {
    const { size, members } = this.structs[name];
    const at = this.allocate(size);
    this.bytes(at, size).fill(0);
    if ('size' in members) this.view.setUint32(at + members.size, size, true);
    return at;
  }
}

let starting, started;
/** The one module of this page, started by the first call. */
export function core(source) {
  starting ??= Core.start(source).then((c) => started = c, (error) => { starting = undefined; throw error; });
  return starting;
}
/** The same for calls that return at once. @throws Error before it has started */
export function running() {
  if (!started) throw new Error('palpable.wasm has not started: await load() or loadBody() first');
  return started;
}
