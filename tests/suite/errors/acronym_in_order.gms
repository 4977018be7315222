* Acronyms have no order: `<` and its like are errors.
acronym word;
parameter p(*) / a word, b 3 /;
scalar s;
s = p('a') > 2;
s = 1$(p('a') <= p('b'));
s = p('a') = word;
*= s 1
*! execution 5
*! execution 6
