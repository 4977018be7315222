// The few calls of WASI that bmod makes: the clock, random numbers, what a panic says. Everything else is refused.

const BADF = 8;
const NOSYS = 52;

export function wasi(memory: () => WebAssembly.Memory, complain: (text: string) => void): WebAssembly.ModuleImports {
  const view = () => new DataView(memory().buffer);
  const none = (counts: number, bytes: number) => {
    view().setUint32(counts, 0, true);
    view().setUint32(bytes, 0, true);
    return 0;
  };
  const known: WebAssembly.ModuleImports = {
    clock_time_get(clock: number, _precision: bigint, at: number) {
      // 0 is the time of day, everything else a clock that does not go back.
      const ms = clock === 0 ? Date.now() : performance.now();
      view().setBigUint64(at, BigInt(Math.round(ms * 1e6)), true);
      return 0;
    },
    random_get(at: number, n: number) {
      for (let k = 0; k < n; k += 65536) {
        crypto.getRandomValues(new Uint8Array(memory().buffer, at + k, Math.min(65536, n - k)));
      }
      return 0;
    },
    fd_write(fd: number, parts: number, count: number, written: number) {
      if (fd !== 1 && fd !== 2) return BADF;
      let total = 0;
      let text = '';
      for (let k = 0; k < count; k++) {
        const at = view().getUint32(parts + 8 * k, true);
        const n = view().getUint32(parts + 8 * k + 4, true);
        text += new TextDecoder().decode(new Uint8Array(memory().buffer, at, n));
        total += n;
      }
      complain(text);
      view().setUint32(written, total, true);
      return 0;
    },
    environ_sizes_get: none,
    environ_get: () => 0,
    args_sizes_get: none,
    args_get: () => 0,
    sched_yield: () => 0,
    proc_exit(code: number) {
      throw new Error(`bmod ended with ${code}`);
    },
  };
  return new Proxy(known, { get: (calls, name: string) => calls[name] ?? (() => (name.startsWith('fd_') ? BADF : NOSYS)) });
}
