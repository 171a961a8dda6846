// The service worker of a site: all files of one version are kept, so that the page works offline.

const { version, files } = JSON.parse("SITE_FILES");
const NAME = `babyrobot-editor ${self.registration.scope} `;

self.addEventListener("install", (event) => {
  event.waitUntil(caches.open(NAME + version).then((cache) => cache.addAll(files)));
});

self.addEventListener("activate", (event) => {
  const isOld = (name) => name.startsWith(NAME) && name !== NAME + version;
  const tidied = caches.keys().then((names) => Promise.all(names.filter(isOld).map((name) => caches.delete(name))));
  event.waitUntil(tidied);
});

self.addEventListener("fetch", (event) => {
  if (event.request.method !== "GET" || !event.request.url.startsWith(self.registration.scope)) return;
  const kept = caches.open(NAME + version).then(async (cache) => {
    const found = await cache.match(event.request, { ignoreSearch: true });
    if (found !== undefined) return found;
    const answer = await fetch(event.request);
    // NumPy and SciPy, once they were asked for.
    if (answer.ok && event.request.url.startsWith(`${self.registration.scope}python/`))
      await cache.put(event.request, answer.clone());
    return answer;
  });
  event.respondWith(kept);
});
