// A browser with the site in it.

import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';

const QUIET = ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'];

export const browser = () => chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: QUIET });

/** A page that fails the test when a script of it fails. */
export async function open(browser, address, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, permissions: ['clipboard-read', 'clipboard-write'], ...options });
  const page = await context.newPage();
  page.failures = [];
  page.on('pageerror', (e) => page.failures.push(String(e)));
  await page.goto(address);
  return page;
}

/** Until the run is over: the report. */
export async function answer(page, timeout = 60_000) {
  await page.waitForSelector('body[data-state=done]', { timeout });
  await page.click('#tab-json');
  const text = await page.textContent('#panel pre');
  await page.click('#tab-answer');
  return JSON.parse(text);
}

export async function run(page, timeout) {
  await page.evaluate(() => (document.body.dataset.state = ''));
  await page.click('#run');
  return answer(page, timeout);
}

/** Puts another text into the editor, as a person would. */
export async function type(page, text) {
  await page.click('.cm-content');
  await page.keyboard.press('ControlOrMeta+a');
  await page.evaluate((t) => navigator.clipboard.writeText(t), text);
  await page.keyboard.press('ControlOrMeta+v');
}

export function same(a, b, tolerance, what) {
  if (typeof a !== 'number' || typeof b !== 'number') return assert.deepEqual(a, b, what);
  assert.ok(Math.abs(a - b) <= tolerance * Math.max(1, Math.abs(a), Math.abs(b)), `${what}: ${a} and ${b}`);
}
