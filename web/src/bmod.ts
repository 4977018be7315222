// bmod as a function: a request goes in, an answer comes out. For workers and for Node.js.

import { wasi } from './wasi';

/** bmod understood and said no. */
export class Refused extends Error {}

export type Listener = { print?(text: string): void; progress?(text: string): void; complain?(text: string): void };
export type Call = (request: unknown) => any;

type Exports = {
  memory: WebAssembly.Memory;
  _initialize?(): void;
  bmod_alloc(n: number): number;
  bmod_call(p: number, n: number): number;
  bmod_free(p: number): void;
};

export async function start(module: WebAssembly.Module, listener: Listener): Promise<Call> {
  let bmod: Exports;
  const text = (p: number, n: number) => new TextDecoder().decode(new Uint8Array(bmod.memory.buffer, p, n));
  const instance = await WebAssembly.instantiate(module, {
    wasi_snapshot_preview1: wasi(() => bmod.memory, (t) => listener.complain?.(t)),
    bmod: {
      print: (p: number, n: number) => listener.print?.(text(p >>> 0, n)),
      progress: (p: number, n: number) => listener.progress?.(text(p >>> 0, n)),
    },
  });
  bmod = instance.exports as unknown as Exports;
  bmod._initialize?.();
  return (request) => {
    const bytes = new TextEncoder().encode(JSON.stringify(request));
    const p = bmod.bmod_alloc(bytes.length) >>> 0;
    new Uint8Array(bmod.memory.buffer, p, bytes.length).set(bytes);
    const q = bmod.bmod_call(p, bytes.length) >>> 0;
    const n = new DataView(bmod.memory.buffer).getUint32(q, true);
    const answer = JSON.parse(text(q + 4, n));
    bmod.bmod_free(q);
    if (answer?.error) throw new Refused(answer.error);
    return answer;
  };
}
