// Models of somebody who means harm: each tries to get a script, a picture or a link of its own into the page. What would run
// says `harm()`.

const tags = [
  `<img src=x onerror=harm()>`,
  `<script>harm()</script>`,
  `<svg onload=harm()>`,
  `<a href="javascript:harm()">x</a>`,
  `"><iframe srcdoc="<script>parent.harm()</script>">`,
  `</text></svg><script>harm()</script>`,
  `<style>@import "http://127.0.0.1:9/x"</style>`,
  `<math><mtext><table><mglyph><style><img src=x onerror=harm()>`,
];

/** A text between quotes of the language. */
const quoted = (t) => (t.includes("'") ? `"${t}"` : `'${t}'`);

const model = (t) => `$title ${t}
* @slider n 0 10 1 ${quoted(t)}
Sets i ${quoted(t)} / ${quoted(t)} ${quoted(t)}, b /;
Parameter p(i) ${quoted(t)} / ${quoted(t)} 3, b 5 /;
Scalar n ${quoted(t)} / 4 /;
Positive variable x(i) ${quoted(t)};  Variable z;
Equations value, room(i) ${quoted(t)};
value..    z =e= sum(i, p(i)*x(i));
room(i)..  x(i) =l= n;
Model shop ${quoted(t)} / all /;
solve shop using lp maximizing z;
display ${quoted(t)}, x.l;
figure f ${quoted(t)} {
   line(i)  x = ord(i), y = p(i), stroke = ${quoted(t)}, label = ${quoted(t)};
   title    ${quoted(t)};
   xaxis    ${quoted(t)};
};
draw f 'f.svg';
File out / ${quoted(`${t.replaceAll('/', '_')}.html`)} /;
put out ${quoted(t)};
`;

export const hostile = [
  ...tags.map((t) => ({ name: t, text: model(t) })),
  // Errors that quote the text.
  ...tags.map((t) => ({ name: `error ${t}`, text: `Set ${t};\nScalar y; y = ${quoted(t)};\nabort ${quoted(t)};` })),
  ...tags.map((t) => ({ name: `abort ${t}`, text: `Scalar y / 1 /;\nabort ${quoted(t)}, y;` })),
  // Exercises: hints and claims.
  ...tags.map((t) => ({ name: `exercise ${t}`, text: `* @exercise\n* @hint ${t}\nScalar y / 1 /;\n*= ${t} 1\n*= y('a 2\n` })),
  { name: 'not a model', text: tags.join('\n') },
  { name: 'a long line', text: `* ${'<b>'.repeat(100_000)}\nScalar y / 1 /;` },
  { name: 'deeply nested', text: `Scalar y; y = ${'('.repeat(20_000)}1${')'.repeat(20_000)};` },
  { name: 'special names', text: `Set __proto__ / constructor, prototype, toString /;\nParameter hasOwnProperty(__proto__);\ndisplay __proto__;` },
];

/** Projects in a link: names of files. */
export const hostileFiles = {
  ...Object.fromEntries(tags.map((t) => [`${t}.inc`, `Scalar q / 1 /;`])),
  __proto__x: 'Scalar q / 1 /;',
  '../../etc/passwd': 'x',
};
