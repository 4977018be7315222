// Examples of the pages run in place: the playground in a frame takes the place of the text.
for (const example of document.querySelectorAll('.example')) {
  const button = document.createElement('button');
  button.textContent = 'Run';
  button.addEventListener('click', () => {
    const frame = document.createElement('iframe');
    frame.title = example.dataset.file;
    frame.src = `../index.html?embed&run#text=${encodeURIComponent(example.querySelector('pre').textContent)}`;
    example.replaceWith(frame);
  });
  example.append(button);
}
