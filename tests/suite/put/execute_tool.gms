* bmod only: programs for data and viewers are passed over, as `execute` is

scalar x / 3 /;
executeTool 'csvwrite id=x file=x.csv';
executeTool.checkErrorLevel 'win32.ShellExecute "x.html"';
x = x + 1;
*= x 4
