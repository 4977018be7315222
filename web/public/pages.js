// Examples of the pages run in place: the playground in a frame takes the place of the text.
const site = document.querySelector('nav a').href.replace(/index\.html$/, '');
for (const example of document.querySelectorAll('.example')) {
  const button = document.createElement('button');
  button.textContent = 'Run';
  button.addEventListener('click', () => {
    const frame = document.createElement('iframe');
    frame.title = example.dataset.file;
    frame.src = `${site}index.html?embed&run&claims#text=${encodeURIComponent(example.querySelector('pre').textContent)}`;
    example.replaceWith(frame);
  });
  example.append(button);
}
