* What hands data to another program and gives nothing back is passed over: it does not cost the results.
set i / a, b /;
parameter p(i);
p(i) = ord(i);
embeddedCode Connect:
- GAMSReader:
    symbols: all
- ExcelWriter:
    file: out.xlsx
endEmbeddedCode
p(i) = p(i) + 1;
$libInclude xldump p out.xls sheet!a1
$libInclude win32 shellExecute "out.html"
$onEmbeddedCode Connect:
- CSVWriter:
    file: out.csv
    name: p
$offEmbeddedCode
embeddedCode Python:
print(list(gams.get("p")))
endEmbeddedCode
p('a') = 5;
*= p('a') 5
*= p('b') 3
