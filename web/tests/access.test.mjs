// What axe-core finds wrong for people who see, hear or point differently: nothing. Every tab and every other thing of the
// page, light and dark, as wide as a desk's screen and as a phone's.

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { after, before, test } from 'node:test';
import { answer, browser as launch, open, type } from './page.mjs';
import { dist, serve } from './serve.mjs';

const axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const SIZES = { desk: { width: 1280, height: 800 }, phone: { width: 390, height: 844 } };

let site, browser;
before(async () => {
  site = await serve();
  browser = await launch();
});
after(async () => {
  await browser?.close();
  site?.close();
});

/** Looks at the page as it is now, in four ways; adds to `found` what is wrong: the rule and the element, and where it was seen. */
async function looked(page, what, found) {
  for (const [name, size] of Object.entries(SIZES)) {
    for (const colorScheme of ['light', 'dark']) {
      await page.setViewportSize(size);
      await page.emulateMedia({ colorScheme, reducedMotion: 'reduce' });
      // In the dark nothing but colours is different.
      const only = colorScheme === 'dark' ? { runOnly: ['color-contrast'] } : {};
      const options = { resultTypes: ['violations', 'incomplete'], iframes: false, ...only };
      const { violations, incomplete } = await page.evaluate((o) => window.axe.run(document, o), options);
      // Where it cannot tell the contrast, because something shines through, there is to be nothing that does.
      for (const v of incomplete.filter((v) => v.id === 'color-contrast')) {
        const nodes = v.nodes.filter((n) => n.any.some((a) => a.data?.messageKey === 'bgGradient'));
        if (nodes.length) violations.push({ ...v, nodes });
      }
      for (const v of violations) {
        for (const n of v.nodes) {
          const wrong = `${v.id} (${v.impact}): ${n.target.flat().join(' ')}: ${n.failureSummary.split('\n')[1]?.trim()}`;
          found.set(wrong, [...(found.get(wrong) ?? []), `${what}/${name}/${colorScheme}`]);
        }
      }
    }
  }
  await page.setViewportSize(SIZES.desk);
}

/** A page, what to look at in it one after the other, and nothing may be wrong. */
async function fine(address, looks) {
  const page = await open(browser, address);
  await page.evaluate(axe);
  const found = new Map();
  await looks(page, (what) => looked(page, what, found));
  assert.equal([...found].map(([wrong, where]) => `\n${wrong}\n   in ${where.join(', ')}`).join(''), '');
  assert.deepEqual(page.failures, []);
  await page.context().close();
}

const TABS = ['formulas', 'dual', 'kkt', 'words', 'prices', 'why', 'steps', 'rows', 'json', 'answer'];

/** Until the tab shows what it asked for. */
async function show(page, tab) {
  await page.click(`#tab-${tab}`);
  await page.waitForFunction(() => !document.querySelector('#panel').textContent.startsWith('Running'));
}

test('every tab', async () => {
  await fine(`${site.site}#model=teaching/transport.blk`, async (page, look) => {
    await answer(page);
    for (const tab of TABS) {
      await show(page, tab);
      await look(tab);
    }
    for (const summary of await page.locator('#panel summary').all()) await summary.click();
    await page.waitForSelector('.table');
    await look('tables');
  });
});

test('figures and sliders', async () => {
  await fine(`${site.site}#model=wall.blk&tab=figures`, async (page, look) => {
    await page.waitForSelector('body[data-state=done]');
    await look('figures');
  });
});

test('errors, completion, hover, search', async () => {
  await fine(`${site.site}#model=teaching/transport.blk`, async (page, look) => {
    await answer(page);
    await type(page, "Set i 'towns' / a, b /;\nParameter price(i) 'per ton' / a 3, b 5 /;\nScalar y;\ny = sum(i, prce(i));\n");
    await page.waitForSelector('.cm-lintRange-error');
    await page.click('#run');
    await page.waitForSelector('.diagnostic');
    await look('an error');
    await page.hover('.cm-lintRange-error');
    await page.waitForSelector('.cm-tooltip .message');
    await look('a message');
    await page.mouse.move(0, 0);
    await page.click('.cm-content');
    await page.keyboard.press('ControlOrMeta+End');
    await page.keyboard.type('y = pri', { delay: 60 });
    await page.waitForSelector('.cm-tooltip-autocomplete');
    await look('completion');
    await page.keyboard.press('Escape');
    await page.keyboard.press('ControlOrMeta+f');
    await page.waitForSelector('.cm-search');
    await look('search');
    await page.keyboard.press('Escape');
    await page.locator('.tok-parameter').first().hover();
    await page.waitForSelector('.cm-tooltip .hover');
    await look('hover');
  });
});

test('examples, tour, messages, an exercise', async () => {
  await fine(`${site.site}#model=exercises/1_bakery.blk`, async (page, look) => {
    await answer(page);
    await page.click('#exercise button');
    await look('an exercise');
    await page.click('#share');
    await page.waitForSelector('#toast:not([hidden])');
    await look('shared');
    await page.click('#examples');
    await page.waitForSelector('#gallery[open] .cards');
    await look('examples');
    await page.locator('#gallery button', { hasText: 'Close' }).click();
    await page.click('#tour');
    for (let step = 1; step <= 6; step++) {
      await page.waitForSelector(`#tip:has-text("Step ${step} of 6")`);
      await page.waitForFunction(() => document.body.dataset.state === 'done');
      await look(`step ${step} of the tour`);
      await page.click('#tip .primary');
    }
  });
});

test('a model in a frame', async () => {
  await fine(`${site.site}index.html?embed&run&readonly#model=wall.blk&tab=figures`, async (page, look) => {
    await page.waitForSelector('body[data-state=done]');
    await look('a frame');
  });
});

test('pages', async () => {
  for (const name of readdirSync(`${dist}docs`).filter((f) => f.endsWith('.html'))) {
    await fine(`${site.site}docs/${name}`, async (page, look) => look(name));
  }
});
