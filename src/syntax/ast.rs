//! The syntax tree. Every node has its span; nothing is resolved yet.
//!
//! What the grammar cannot tell apart is kept as one node until names are known: `p(i+1)` is an
//! [`Expr`] of kind [`ExprKind::Apply`] whether `p` is a parameter with a lead or a function of a sum.

use crate::data::value;
pub use crate::model::instance::{Relation, Sense};
use crate::model::named::named;
use crate::source::{Span, Switches};

/// A name as it was spelled. Names are compared without regard to case.
#[derive(Clone, Debug, PartialEq)]
pub struct Ident {
    /// Spelling.
    pub name: Box<str>,
    /// Place.
    pub span: Span,
}

/// A statement.
#[derive(Clone, Debug)]
pub struct Stmt {
    /// What it says.
    pub kind: StmtKind,
    /// From its first word to its `;`.
    pub span: Span,
    /// Switches in force.
    pub modes: Switches,
}

/// The kinds of statements.
#[derive(Clone, Debug)]
pub enum StmtKind {
    /// `set i 'plants' / seattle, denver /, arc(i,j);`
    Set(Vec<SetDecl>),
    /// `alias (i, j), (k, l);` each group: names, one of which is known already.
    Alias(Vec<Vec<Ident>>),
    /// `parameter`, `scalar`.
    Parameter(Vec<ParameterDecl>),
    /// `table`.
    Table(TableDecl),
    /// `variable` of any kind.
    Variable(VariableKind, Vec<SymbolDecl>),
    /// `equation`.
    Equation(Vec<SymbolDecl>),
    /// `model`.
    Model(Vec<ModelDecl>),
    /// `$clear p`, `$kill p`: what data statements gave is forgotten, with `$kill` also that there were any.
    Clear {
        /// Written `$kill`.
        kill: bool,
        /// The symbols.
        names: Vec<Ident>,
    },
    /// `acronym`.
    Acronym(Vec<SymbolDecl>),
    /// `file f 'text' / out.txt /;` the name of the file is None where none is given.
    File(Vec<FileDecl>),
    /// `function f /stolib.dnormal/`: names for functions of a library.
    Function(Vec<FileDecl>),
    /// `p(i)$c = e;` also to attributes and sets.
    Assign(Assign),
    /// `e(i)$c .. l =e= r;`
    Equate(Equate),
    /// `solve m using lp minimizing z;`
    Solve(Solve),
    /// `loop((i,j)$c, …);`
    Loop(Domain, Vec<Stmt>),
    /// `while(c, …);`
    While(Expr, Vec<Stmt>),
    /// `for(k = a to|downto b by s, …);`
    For(For<Reference, Expr, Stmt>),
    /// `repeat(… until c);`
    Repeat(Vec<Stmt>, Expr),
    /// `if(c, … elseif c, … else …);`
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    /// `break n;` leaves `n` loops (1 where no number stands).
    Break(u32),
    /// `continue;`
    Continue,
    /// `display 'text', p, x.l;`
    Display(Vec<DisplayItem>),
    /// `abort 'text', p;` true for `abort.noError`.
    Abort(Vec<DisplayItem>, bool),
    /// `option …;`
    Option(Vec<OptionItem>),
    /// `put` and its kin: `putclose`, `puttl`, `puthd`, `putpage` … in lower case, and the items; a file symbol comes as an
    /// `Item` whose expression is a bare name.
    Put(Box<str>, Vec<PutItem>),
    /// `execute_unload`, `execute_load`, `execute_loadpoint`, `$load`, `$gdxin` …
    Exchange(Exchange),
    /// A statement that is understood and refused or without effect (`execute 'cmd'`): its keyword.
    Refused(Ident),
    /// `figure name 'title' { … };`
    Figure(Figure),
    /// `draw figure 'file.svg';`
    Draw(Ident, Option<Expr>),
    /// Nothing (`;` alone, listing control).
    Empty,
}

/// One index position of a declaration: `i`, `*`, or `i<` (the symbol defines the set).
#[derive(Clone, Debug)]
pub struct DomainName {
    /// The set; `*` is the universe.
    pub name: Ident,
    /// `<` stands behind it.
    pub defines: bool,
}

/// A name with index positions, an explanatory text and perhaps data.
#[derive(Clone, Debug)]
pub struct SymbolDecl {
    /// The name.
    pub name: Ident,
    /// Index positions; None where no parentheses stand.
    pub domain: Option<Vec<DomainName>>,
    /// Explanatory text.
    pub text: Option<Box<str>>,
    /// The body between the slashes, to be read by the data lexer.
    pub data: Option<Span>,
}

impl SymbolDecl {
    /// By position: whether the data make the domain's set (`p(i<)`).
    pub fn defines(&self) -> Vec<bool> {
        self.domain.iter().flatten().map(|d| d.defines).collect()
    }
}

/// A set of a `set` statement.
#[derive(Clone, Debug)]
pub struct SetDecl {
    /// Name, domain, text, data.
    pub symbol: SymbolDecl,
    /// `singleton set`.
    pub singleton: bool,
}

/// A parameter or scalar.
#[derive(Clone, Debug)]
pub struct ParameterDecl {
    /// Name, domain, text, data.
    pub symbol: SymbolDecl,
    /// Declared by `scalar`.
    pub scalar: bool,
}

/// What a table says it gives values to, where the symbol is new.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TableOf {
    /// `table`, `parameter table`.
    Parameter,
    /// `set table`: cells are `yes`, or nothing.
    Set,
    /// `variable table`: the columns are attributes.
    Variable(VariableKind),
}

/// Tables: the data of the last is everything from the line after its header to the `;`, to be read by the table
/// lexer. Those before it, and the last where no lines follow, are only declared.
#[derive(Clone, Debug)]
pub struct TableDecl {
    /// What they give values to.
    pub of: TableOf,
    /// Name, domain, text, lines.
    pub symbols: Vec<SymbolDecl>,
}

named! {
    /// Kinds of variables.
    pub enum VariableKind {
        /// No kind written: free if new, unchanged if known.
        Unstated "";
        /// −∞ … +∞.
        Free "free";
        /// 0 … +∞.
        Positive "positive" | "nonnegative";
        /// −∞ … 0.
        Negative "negative";
        /// 0 or 1.
        Binary "binary";
        /// Integers 0 … +∞.
        Integer "integer";
        /// 0 or between bounds.
        SemiContinuous "semicont";
        /// 0 or an integer between bounds.
        SemiInteger "semiint";
        /// Special ordered set of type 1.
        Sos1 "sos1";
        /// Special ordered set of type 2.
        Sos2 "sos2";
    }
}

impl VariableKind {
    /// Whether its values are more than a range.
    pub fn is_discrete(self) -> bool {
        !matches!(
            self,
            Self::Unstated | Self::Free | Self::Positive | Self::Negative
        )
    }
}

/// `model m 'text' / all, -e2, f.x, (g,h).y /;`
#[derive(Clone, Debug)]
pub struct ModelDecl {
    /// The name.
    pub name: Ident,
    /// Explanatory text.
    pub text: Option<Box<str>>,
    /// Its parts; None where no slashes stand.
    pub items: Option<Vec<ModelItem>>,
}

/// One part of a model's list.
#[derive(Clone, Debug)]
pub enum ModelItem {
    /// `all`.
    All(Span),
    /// An equation or another model.
    Add(Ident),
    /// `x(s)`: the columns of a variable are those whose labels are in a set.
    Limit(Ident, Vec<Ident>),
    /// `- e` or `- m`.
    Remove(Ident),
    /// `f.x`, `(f|g).x`, `(f,g):x`.
    Pair {
        /// The equations.
        rows: Vec<Ident>,
        /// The variable.
        column: Ident,
    },
}

/// A symbol with its attribute and arguments, where something is assigned or referred to.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The symbol.
    pub name: Ident,
    /// `.l`, `.lo`, `.modelstat` …
    pub attribute: Option<Ident>,
    /// Indices; empty where none stand.
    pub indices: Vec<Expr>,
    /// Whole place.
    pub span: Span,
}

/// An assignment.
#[derive(Clone, Debug)]
pub struct Assign {
    /// Left side.
    pub target: Reference,
    /// Condition on the left.
    pub condition: Option<Expr>,
    /// Right side.
    pub value: Expr,
    /// Written `$=`: only where the right side is not 0.
    pub nonzero: bool,
}

/// The definition of an equation.
#[derive(Clone, Debug)]
pub struct Equate {
    /// The equation.
    pub name: Ident,
    /// Index positions: sets, labels, lags, tuple sets `arc(i,j)`.
    pub indices: Vec<Expr>,
    /// Condition.
    pub condition: Option<Expr>,
    /// Left side.
    pub left: Expr,
    /// Relation.
    pub relation: Relation,
    /// Right side.
    pub right: Expr,
}

/// A `solve` statement.
#[derive(Clone, Debug)]
pub struct Solve {
    /// The model.
    pub model: Ident,
    /// `lp`, `nlp`, `mcp` …
    pub using: Ident,
    /// Direction and objective variable.
    pub objective: Option<(Sense, Ident)>,
    /// The dictionary of `scenario dict`.
    pub scenario: Option<Ident>,
}

/// What a loop, a sum or a figure element runs over: `(i, arc(j,k))$c`.
#[derive(Clone, Debug)]
pub struct Domain {
    /// The items in the order written.
    pub items: Vec<DomainItem>,
    /// Condition.
    pub condition: Option<Expr>,
    /// Whole place.
    pub span: Span,
}

/// `i` or `arc(j,'b')`.
#[derive(Clone, Debug)]
pub struct DomainItem {
    /// The set.
    pub set: Ident,
    /// `i.local`: an index of its own, though `i` may be under control outside.
    pub local: bool,
    /// Its indices; None where no parentheses stand.
    pub indices: Option<Vec<Expr>>,
    /// Whole place.
    pub span: Span,
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// Where it is.
    pub span: Span,
}

/// The kinds of expressions.
#[derive(Clone, Debug)]
pub enum ExprKind {
    /// A number, or `inf`, `eps`, `na`, `undf` (see `data::value`).
    Number(f64),
    /// `yes`, `no`.
    Membership(bool),
    /// A quoted text: a label in an index position, a text in `put`.
    Text(Box<str>),
    /// A name, perhaps with an attribute (`.l`, `.val`), and with arguments where parentheses stand: symbol, function or index, told
    /// apart later.
    Apply(Ident, Option<Ident>, Option<Vec<Expr>>),
    /// A prefix operator.
    Unary(UnaryOp, Box<Expr>),
    /// An infix operator.
    Binary(BinaryOp, Box<Expr>, Box<Expr>),
    /// A chain of two or more terms joined by `+` and `-`; true for those that are subtracted.
    Sum(Vec<(bool, Expr)>),
    /// A chain of three or more factors joined by `*` and `/`, left to right; true for those that divide.
    Product(Vec<(bool, Expr)>),
    /// `e $ c`.
    Dollar(Box<Expr>, Box<Expr>),
    /// `sum((i,j)$c, e)` and its kin.
    Aggregate(AggregateOp, Box<Domain>, Box<Expr>),
}

/// Prefix operators.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnaryOp {
    /// `-`
    Minus,
    /// `+`
    Plus,
    /// `not`
    Not,
}

named! {
    /// Infix operators, loosest first: `-> <=>`, `or xor`, `and`, (`not`), relations, `+ -`, `* /`, (unary minus), `**`, `$`.
    pub enum BinaryOp {
        Implies "imp" | "->";
        Equivalent "eqv" | "<=>";
        Or "or";
        Xor "xor";
        And "and";
        Eq "=" | "eq";
        Ne "<>" | "ne";
        Lt "<" | "lt";
        Le "<=" | "le";
        Gt ">" | "gt";
        Ge ">=" | "ge";
        Add "+";
        Subtract "-";
        Multiply "*";
        Divide "/";
        Power "**";
        /// In an index position: circular lead.
        CircularPlus "++";
        /// In an index position: circular lag.
        CircularMinus "--";
    }
}

named! {
    /// Operators over a domain.
    pub enum AggregateOp {
        Sum "sum";
        Prod "prod";
        Smin "smin";
        Smax "smax";
        Sand "sand";
        Sor "sor";
    }
}

impl AggregateOp {
    /// Its value where there is nothing to run over.
    pub fn of_nothing(self) -> f64 {
        match self {
            Self::Sum | Self::Sor => 0.0,
            Self::Prod | Self::Sand => 1.0,
            Self::Smin => f64::INFINITY,
            Self::Smax => f64::NEG_INFINITY,
        }
    }
}

/// A file of `put`.
#[derive(Clone, Debug)]
pub struct FileDecl {
    /// Its name in the model.
    pub name: Ident,
    /// Explanatory text.
    pub text: Option<Box<str>>,
    /// Its name outside.
    pub path: Option<Box<str>>,
}

/// One item of `display` and `abort`.
#[derive(Clone, Debug)]
pub enum DisplayItem {
    /// A text.
    Text(Box<str>, Span),
    /// A symbol, perhaps with attribute.
    Symbol(Reference),
}

/// One item of an `option` statement.
#[derive(Clone, Debug)]
pub struct OptionItem {
    /// Option or symbol.
    pub name: Ident,
    /// Index names of a projection's left side.
    pub indices: Option<Vec<Ident>>,
    /// The rest.
    pub form: OptionForm,
}

/// Forms of an option item.
#[derive(Clone, Debug)]
pub enum OptionForm {
    /// `option oneOutput;`
    Flag,
    /// `option lp = clarabel`, `option reslim = 5`, `option clear = p` (names come as text).
    Assign(OptionValue),
    /// `option p:3:1:2`
    Format(Vec<i64>),
    /// `option p < q` (`<=` looks for the index sets from the left).
    Project {
        /// Written `<=`.
        from_left: bool,
        /// The source.
        source: Ident,
        /// Its index names.
        indices: Option<Vec<Ident>>,
    },
    /// `option p > s`: the orders of a set's elements.
    Permute(Ident),
    /// `option m(i:j,k)`: from left to right, a set behind a colon (true) is matched one by one, one behind
    /// a comma multiplied out.
    Match(Vec<(bool, Ident)>),
}

/// Right side of `option name = …`.
#[derive(Clone, Debug)]
pub enum OptionValue {
    /// A number.
    Number(f64),
    /// A name or a text, with its place.
    Text(Box<str>, Span),
}

/// `for(k = from to limit by step, …);` as it is written, and as it is checked.
#[derive(Clone, Debug)]
pub struct For<V, E, S> {
    /// The scalar that counts.
    pub variable: V,
    /// First value.
    pub from: E,
    /// `downto`.
    pub down: bool,
    /// Limit.
    pub to: E,
    /// Step, 1 where none is given.
    pub by: Option<E>,
    /// Statements.
    pub body: Vec<S>,
}

/// One item of a `put`.
#[derive(Clone, Debug)]
pub enum PutItem {
    /// `/`: new line.
    NewLine,
    /// `@ n`: to a column.
    Column(Expr),
    /// `# n`: to a line.
    Row(Expr),
    /// Something to write.
    Item(Written<Expr>),
}

/// Something that `put` writes, with `:<width:decimals`.
#[derive(Clone, Debug)]
pub struct Written<E> {
    /// What.
    pub value: E,
    /// `<` left, `>` right, `=` centred (`<>`).
    pub align: Option<char>,
    /// Width.
    pub width: Option<E>,
    /// Decimals.
    pub decimals: Option<E>,
}

/// Data exchange with files.
#[derive(Clone, Debug)]
pub struct Exchange {
    /// `execute_unload`, `execute_load`, `execute_loadpoint`, `gdxin`, `load`, `loaddc`, `gdxout`, `unload` … in lower case.
    pub keyword: Ident,
    /// The file, where one is named.
    pub file: Option<(Box<str>, Span)>,
    /// The symbols.
    pub items: Vec<ExchangeItem>,
}

/// A symbol of a data exchange: `x`, `x = y` with the name in the file, `p = x.l`, `i < p`, `i < p.dim2`.
#[derive(Clone, Debug)]
pub struct ExchangeItem {
    /// The symbol.
    pub name: Ident,
    /// The attribute of the symbol that is loaded: `x.l`, `x.l = p`.
    pub into: Option<Ident>,
    /// Its name in the file; `*` for all labels.
    pub other: Option<Ident>,
    /// `l`, `dim2` …
    pub suffix: Option<Ident>,
    /// How the symbol of the file is taken.
    pub by: ExchangeBy,
}

/// How a symbol of a file is taken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ExchangeBy {
    /// `=`: as it is.
    Name,
    /// `<`: the labels of an index position, the last that fits.
    LastPosition,
    /// `<=`: the labels of an index position, the first that fits.
    FirstPosition,
}

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Its name.
    pub name: Ident,
    /// Title.
    pub title: Option<Box<str>>,
    /// Its elements in drawing order.
    pub elements: Vec<FigureElement>,
}

/// One element of a figure: `polygon(b,v)$c x = …, y = …, fill = …;`
#[derive(Clone, Debug)]
pub struct FigureElement {
    /// `polygon`, `polyline`, `points`, `arrow`, `text`, `line`, `bar`, `title`, `axes` …
    pub kind: Ident,
    /// What it runs over; None where no parentheses stand.
    pub domain: Option<Domain>,
    /// `name = value`, or a bare value.
    pub arguments: Vec<(Option<Ident>, Expr)>,
    /// Whole place.
    pub span: Span,
}

impl ExprKind {
    /// `inf`, `eps` …; `undf` where it may stand.
    pub(crate) fn special(name: &str, undf: impl Fn() -> bool) -> Option<Self> {
        if name.len() > 4 {
            return None;
        }
        Some(Self::Number(match name.to_ascii_lowercase().as_str() {
            "yes" => return Some(Self::Membership(true)),
            "no" => return Some(Self::Membership(false)),
            "inf" => f64::INFINITY,
            "eps" => value::EPS,
            "na" => value::NA,
            "undf" if undf() => value::UNDF,
            _ => return None,
        }))
    }
}
