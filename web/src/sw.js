// The site without a network. All of it is kept under the name of this version; an older version goes when this one is whole.

const version = 'VERSION';
const shell = ['SHELL'];

self.addEventListener('install', (event) => {
  event.waitUntil(caches.open(version).then((cache) => cache.addAll(shell)).then(() => self.skipWaiting()));
});

self.addEventListener('activate', (event) => {
  const old = caches.keys().then((names) => Promise.all(names.filter((n) => n !== version).map((n) => caches.delete(n))));
  event.waitUntil(old.then(() => self.clients.claim()));
});

self.addEventListener('fetch', (event) => {
  const url = new URL(event.request.url);
  if (event.request.method !== 'GET' || url.origin !== location.origin) return;
  const path = url.pathname.endsWith('/index.html') && !url.pathname.endsWith('/docs/index.html') ? './' : event.request;
  event.respondWith(
    caches.open(version).then((cache) => cache.match(path, { ignoreSearch: true, ignoreVary: true })).then((hit) => hit ?? fetch(event.request)),
  );
});
