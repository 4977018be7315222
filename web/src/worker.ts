// A worker that holds bmod. It first gets the compiled module, then one request after the other.

import { Refused, start, type Call } from './bmod';

export type FromWorker =
  | { kind: 'answer'; answer: unknown }
  | { kind: 'failed' | 'refused'; why: string }
  | { kind: 'print' | 'progress'; text: string };

const say = (message: FromWorker) => postMessage(message);
let complaint = '';
let call: Promise<Call> | undefined;

addEventListener('message', async ({ data }: MessageEvent) => {
  if (data instanceof WebAssembly.Module) {
    call = start(data, {
      print: (text) => say({ kind: 'print', text }),
      progress: (text) => say({ kind: 'progress', text }),
      complain: (text) => (complaint += text),
    });
    return;
  }
  complaint = '';
  try {
    say({ kind: 'answer', answer: (await call!)(data) });
  } catch (error) {
    if (error instanceof Refused) say({ kind: 'refused', why: error.message });
    else say({ kind: 'failed', why: complaint || String(error) });
  }
});
