// bmod in workers: one runs models and can be stopped, one answers the editor.

import type { FromWorker } from './worker';
import type { Request } from './protocol';
import wasm from '../target/bmod.wasm?url';

let module: Promise<WebAssembly.Module> | undefined;

/** Compiled once; every worker gets the same. */
export function compiled(): Promise<WebAssembly.Module> {
  return (module ??= compile().catch((error) => {
    module = undefined;
    throw error;
  }));
}

async function compile(): Promise<WebAssembly.Module> {
  const response = await fetch(wasm);
  if (!response.ok) throw new Error(`${response.status} ${response.statusText}`);
  // A file server that does not know the type is no reason to fail.
  const known = response.headers.get('content-type') === 'application/wasm';
  return known ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

export class Stopped extends Error {}

type Job = { request: Request; done(answer: any): void; failed(error: Error): void };

export class Engine {
  private worker: Worker | undefined;
  private queue: Job[] = [];
  private job: Job | undefined;

  /** `turned` hears when the engine begins to work and when it has nothing to do. */
  constructor(private listen: (kind: 'print' | 'progress', text: string) => void = () => {}, private turned: (busy: boolean) => void = () => {}) {}

  private get current(): Job | undefined {
    return this.job;
  }

  private set current(job: Job | undefined) {
    this.job = job;
    this.turned(this.busy);
  }

  get busy(): boolean {
    return this.current !== undefined;
  }

  call<T>(request: Request): Promise<T> {
    return new Promise((done, failed) => {
      this.queue.push({ request, done, failed });
      this.next();
    });
  }

  /** Ends the worker, whatever it does; the next call starts another. */
  stop(): void {
    this.worker?.terminate();
    this.worker = undefined;
    const jobs = [this.current, ...this.queue];
    this.current = undefined;
    this.queue = [];
    for (const job of jobs) job?.failed(new Stopped());
  }

  /** Starts the worker before it is needed. */
  async warm(): Promise<void> {
    const ready = await compiled();
    if (this.worker) return;
    const worker = new Worker(new URL('./worker.ts', import.meta.url), { type: 'module' });
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => this.hear(data);
    worker.onerror = (event) => this.hear({ kind: 'failed', why: event.message || 'the worker could not be started' });
    worker.postMessage(ready);
    this.worker = worker;
  }

  private hear(data: FromWorker): void {
    if ('text' in data) return this.listen(data.kind, data.text);
    const job = this.current;
    this.current = undefined;
    if (data.kind === 'answer') {
      job?.done(data.answer);
    } else if (data.kind === 'refused') {
      job?.failed(new Error(data.why));
    } else {
      // After a failure the module's memory is in doubt.
      this.worker?.terminate();
      this.worker = undefined;
      job?.failed(new Error(data.why));
    }
    this.next();
  }

  private async next(): Promise<void> {
    if (this.current || this.queue.length === 0) return;
    const job = (this.current = this.queue.shift()!);
    try {
      await this.warm();
      if (this.current === job) this.worker!.postMessage(job.request);
    } catch (error) {
      if (this.current === job) this.hear({ kind: 'failed', why: String(error) });
    }
  }
}
