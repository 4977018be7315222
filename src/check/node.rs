//! The checked program: names resolved, indices turned into slots, tables numbered.
//!
//! A controlled index is a *slot*: while a sum, assignment, loop or equation runs, slot k of the
//! frame holds a label. A [`Key`] says how the labels of a record are made from slots.

use crate::data::universe::Label;
use crate::model::instance::Function;
use crate::model::named::{functions, named};
use crate::model::problem_type::ProblemType;
use crate::source::Span;
pub use crate::syntax::ast::{AggregateOp, BinaryOp, For, Relation, Sense, Written};
use std::any::Any;
use std::sync::{Arc, Mutex, OnceLock};

/// Number of a symbol.
pub type SymbolId = u32;
/// Number of a table of the store.
pub type TableId = u32;
/// Number of a slot of the frame.
pub type Slot = u32;

/// How one label of a key is made.
#[derive(Clone, Debug)]
pub enum Part {
    /// The label in a slot.
    Slot(Slot),
    /// A label of the text.
    Label(Label),
    /// The label `offset` places after another in a set.
    Lag(Arc<Lag>),
    /// The one element of a singleton set, at a position of it.
    Singleton(TableId, u8),
}

/// `i+1`, `i--k`.
#[derive(Clone, Debug)]
pub struct Lag {
    /// Where to start: a slot, a label or a singleton.
    pub base: Part,
    /// The ordered set.
    pub set: TableId,
    /// How far; negative for lags.
    pub offset: Node,
    /// `++`, `--`.
    pub circular: bool,
}

/// How the labels of a record are made.
#[derive(Clone, Default, Debug)]
pub struct Key {
    /// One part per position.
    pub parts: Vec<Part>,
}

impl Key {
    /// Whether it names one record by its labels.
    pub fn is_fixed(&self) -> bool {
        let label = |p: &Part| matches!(p, Part::Label(_));
        !self.parts.is_empty() && self.parts.iter().all(label)
    }

    /// Whether all parts are slots and labels.
    pub fn is_plain(&self) -> bool {
        self.parts
            .iter()
            .all(|p| matches!(p, Part::Slot(_) | Part::Label(_)))
    }

    /// Whether an index comes twice.
    pub fn repeats(&self) -> bool {
        let again = |(n, p): (usize, &Part)| match p {
            Part::Slot(s) => self.parts[..n]
                .iter()
                .any(|q| matches!(q, Part::Slot(t) if t == s)),
            _ => false,
        };
        self.parts.iter().enumerate().any(again)
    }
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Node {
    /// What it is.
    pub kind: NodeKind,
    /// Where it is.
    pub span: Span,
    /// Whether a variable (as an unknown) stands in it.
    pub has_var: bool,
    /// Whether it is at most linear in the variables.
    pub linear: bool,
    /// Whether it says that something is in a set, and is no number.
    pub member: bool,
}

impl NodeKind {
    /// What a factor divides by, if it does so by multiplying with the reciprocal.
    pub fn reciprocal_of(&self) -> Option<&Node> {
        match self {
            NodeKind::Product(factors) => match factors.as_slice() {
                [(true, b)] => Some(b),
                _ => None,
            },
            _ => None,
        }
    }
}

/// The kinds of expressions.
#[derive(Clone, Debug)]
pub enum NodeKind {
    /// A number.
    Const(f64),
    /// A parameter, an attribute, or membership of a set (1 or 0).
    Data(TableId, Key),
    /// A variable as an unknown: the symbol and its key.
    Var(SymbolId, Key),
    /// `x.slack` and others that are computed from attributes.
    Derived(Derived, SymbolId, Key),
    /// `ord(i)`: position of a label in a set.
    Ord(TableId, Part),
    /// `card(s)`.
    Card(TableId),
    /// `sameas(i,j)`.
    SameAs(Part, Part),
    /// A property of a label within a set: `i.val`, `i.pos` …
    LabelAttribute(LabelAttribute, TableId, Part),
    /// `not a`
    Not(Box<Node>),
    /// Terms; true for those that are subtracted. There may be one alone: `-a`.
    Sum(Vec<(bool, Node)>),
    /// Factors; true for those that divide.
    Product(Vec<(bool, Node)>),
    /// Relations, logic, `**`.
    Binary(BinaryOp, Box<Node>, Box<Node>),
    /// A mathematical function.
    Call(Function, Vec<Node>),
    /// A function of data only.
    DataCall(DataFunction, Vec<Node>),
    /// `e $ c`
    Dollar(Box<Node>, Box<Node>),
    /// `sum(d, e)` and its kin.
    Aggregate(AggregateOp, Box<Domain>, Box<Node>),
    /// `m.modelstat`, `f.pw` …: the symbol and the attribute in lower case.
    ObjectAttribute(SymbolId, &'static str),
    /// A text, in `put` and figures.
    Text(Box<str>),
    /// Label text of a key part, in `put` and figures.
    LabelText(Part),
    /// Element text of a set record, in `put` and figures.
    ElementText(TableId, Key),
    /// Explanatory text of a symbol.
    SymbolText(SymbolId),
    /// `card('text')`; with a position `ord('text', n)`, the code of a character.
    OfText(Box<Node>, Option<Box<Node>>),
    /// Name of a symbol with its labels, `p('a','b')`, in `put` and figures.
    RecordName(SymbolId, Key),
}

named! {
    /// Attributes that are computed, as `display` shows them.
    #[derive(Hash)]
    pub enum Derived {
        Slack "Slack";
        SlackLo "SlackLo";
        SlackUp "SlackUp";
        Infeas "Infeas";
        Range "Range";
        /// With `option ranging`: from where to where a right-hand side or a cost may go.
        RangeLo "RangeLo";
        RangeUp "RangeUp";
        /// What one unit of a right-hand side less or more is worth.
        PriceLo "PriceLo";
        PriceUp "PriceUp";
    }
}

named! {
    /// Properties of a label within a set.
    pub enum LabelAttribute {
        Val "val";
        Pos "pos";
        Ord "ord";
        Off "off";
        Rev "rev";
        Uel "uel";
        Len "len";
        TextLen "tlen";
        /// The number that the text says.
        TextVal "tval";
        First "first";
        Last "last";
    }
}

functions! {
    /// Functions that never take a variable.
    pub enum DataFunction {
        Uniform "uniform" | "stolib.duniform", 2, 2;
        UniformInt "uniformint" | "stolib.duniformint", 2, 2;
        Normal "normal" | "stolib.dnormal", 2, 2;
        RandBinomial "randbinomial" | "stolib.dbinomial", 2, 2;
        RandLinear "randlinear", 3, 3;
        RandTriangle "randtriangle" | "stolib.dtriangular", 3, 3;
        RandExponential "stolib.dexponential", 1, 1;
        RandPoisson "stolib.dpoisson", 1, 1;
        SetSeed "stolib.setseed", 1, 1;
        Fact "fact", 1, 1;
        Mapval "mapval", 1, 1;
        Pi "pi", 0, 0;
        ExecSeed "execseed", 0, 0;
        JNow "jnow", 0, 0;
        JStart "jstart", 0, 0;
        JDate "jdate", 3, 3;
        JTime "jtime", 3, 3;
        GYear "gyear", 1, 1;
        GMonth "gmonth", 1, 1;
        GDay "gday", 1, 1;
        GHour "ghour", 1, 1;
        GMinute "gminute", 1, 1;
        GSecond "gsecond", 1, 1;
        GMillisec "gmillisec", 1, 1;
        GDow "gdow", 1, 1;
        GLeap "gleap", 1, 1;
        TimeElapsed "timeelapsed" | "timeexec", 0, 0;
        ExecError "execerror", 0, 0;
        MaxExecError "maxexecerror", 0, 0;
        ErrorLevel "errorlevel", 0, 0;
        /// Machine and licence facts that have no meaning here: 0.
        Zero "timecomp" | "timestart" | "timeclose" | "heapsize" | "heapfree" | "heaplimit"
            | "mathlastrc" | "mathlastec" | "mathoval" | "licensestatus", 0, 0;
        One "numcores" | "platformcode" | "licenselevel", 0, 0;
        GamsVersion "gamsversion", 0, 0;
        GamsRelease "gamsrelease", 0, 0;
        Sleep "sleep", 1, 1;
        HandleCollect "handlecollect", 1, 1;
        HandleStatus "handlestatus", 1, 1;
        HandleDelete "handledelete", 1, 1;
        HandleSubmit "handlesubmit", 1, 1;
        /// Whether nothing is left to wait for; 0, for nothing ever is.
        ReadyCollect "readycollect", 1, 2;
    }
}

/// A record that must exist for a tuple to count: the table and the key.
#[derive(Clone, Debug)]
pub struct Driver {
    /// Set or parameter.
    pub table: TableId,
    /// Its key.
    pub key: Key,
}

/// What runs over tuples.
#[derive(Clone, Debug, Default)]
pub struct Domain {
    /// Slots that this domain sets, in the order written.
    pub slots: Vec<Slot>,
    /// The set of each slot (what the label must be a member of).
    pub sets: Vec<TableId>,
    /// The set, or the alias of one, that each slot runs over, as it was written.
    pub names: Vec<SymbolId>,
    /// Tuple sets and the index sets: all must hold.
    pub members: Vec<Driver>,
    /// Conjuncts of the condition.
    pub conditions: Vec<Node>,
    /// How to enumerate: what the run makes of it at first use, and only the run knows.
    pub plan: Memo,
}

/// Kept at first use; a copy begins without.
#[derive(Debug, Default)]
pub struct Memo(pub Mutex<Option<Arc<dyn Any + Send + Sync>>>);

impl Clone for Memo {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The definition of an equation.
#[derive(Debug)]
pub struct EquationDef {
    /// The equation.
    pub symbol: SymbolId,
    /// What it runs over.
    pub domain: Domain,
    /// Label of the row.
    pub key: Key,
    /// Left side.
    pub left: Node,
    /// Relation.
    pub relation: Relation,
    /// Right side.
    pub right: Node,
    /// The sets that run in it: those of its domain, sums and products.
    pub running: Vec<SymbolId>,
    /// Place.
    pub span: Span,
}

/// What an assignment writes to.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Target {
    /// A parameter or an attribute.
    Table(TableId),
    /// A set: true adds, false removes.
    Set(TableId),
    /// A singleton set.
    Singleton(TableId),
    /// `.fx` of a variable.
    Fix(SymbolId),
    /// A model or file attribute.
    Object(SymbolId, &'static str),
    /// `execseed = n`
    Seed,
    /// `execerror = n`
    Errors,
    /// `maxexecerror = n`
    MostErrors,
    /// `heaplimit`: a limit of a GAMS installation.
    Ignored,
}

/// A statement.
#[derive(Debug)]
pub struct Code {
    /// What it does.
    pub kind: CodeKind,
    /// Where it is.
    pub span: Span,
    /// Tables that it may scan, found when first run: they must be tidy before.
    pub scans: OnceLock<Box<[TableId]>>,
}

impl Code {
    /// A statement.
    pub fn new(kind: CodeKind, span: Span) -> Self {
        Self {
            kind,
            span,
            scans: OnceLock::new(),
        }
    }
}

/// One thing to display.
#[derive(Debug)]
pub enum Shown {
    /// A text.
    Text(Box<str>),
    /// A symbol with an attribute (as spelled for people, `L`, `Up`).
    Symbol(SymbolId, Option<&'static str>),
}

/// A solve.
#[derive(Clone, Debug)]
pub struct SolveCode {
    /// The model.
    pub model: SymbolId,
    /// Its equations at this place of the text, and pairs.
    pub equations: Vec<ModelRow>,
    /// Variables that have only the columns whose labels are in a set.
    pub limits: Vec<(SymbolId, SymbolId)>,
    /// Problem type.
    pub using: ProblemType,
    /// Direction and objective variable.
    pub objective: Option<(Sense, SymbolId)>,
    /// The dictionary of the scenarios.
    pub scenario: Option<SymbolId>,
}

/// One equation of a model.
#[derive(Clone, Debug)]
pub struct ModelRow {
    /// Index into `Program::equations`.
    pub definition: usize,
    /// The variable it is paired with.
    pub pair: Option<SymbolId>,
    /// Where the model names it.
    pub span: Span,
}

/// An item of `put`.
#[derive(Debug)]
pub enum PutCode {
    /// `/`
    NewLine,
    /// `@n`
    Column(Node),
    /// `#n`
    Row(Node),
    /// Selects a file.
    File(SymbolId),
    /// Writes.
    Item(Written<Node>),
}

/// One element of a figure.
#[derive(Debug)]
pub struct FigureElementCode {
    /// Kind, lower case.
    pub kind: Box<str>,
    /// What it runs over.
    pub domain: Option<Domain>,
    /// Arguments.
    pub arguments: Vec<(Option<Box<str>>, Node)>,
    /// Place.
    pub span: Span,
}

/// A figure.
#[derive(Debug)]
pub struct FigureCode {
    /// Title.
    pub title: Option<Box<str>>,
    /// Elements.
    pub elements: Vec<FigureElementCode>,
}

/// An assignment.
#[derive(Debug)]
pub struct Assignment {
    /// What it runs over (slots not controlled outside).
    pub domain: Domain,
    /// What is written.
    pub target: Target,
    /// Key of the record.
    pub key: Key,
    /// Right side.
    pub value: Node,
    /// Whether the domain covers every record the target can have.
    pub covers: bool,
    /// `$=`: what is 0 is not assigned.
    pub nonzero: bool,
    /// Element by element: the right side reads what was written before.
    pub in_turn: bool,
}

/// The kinds of statements.
#[derive(Debug)]
pub enum CodeKind {
    /// Assignment.
    Assign(Assignment),
    /// `loop`: conjuncts of its condition that the body may change stand apart.
    Loop(Domain, Vec<Node>, Vec<Code>),
    /// `while`
    While(Node, Vec<Code>),
    /// `for`
    For(For<TableId, Node, Code>),
    /// `repeat`
    Repeat(Vec<Code>, Node),
    /// `if`
    If(Vec<(Node, Vec<Code>)>, Vec<Code>),
    /// `break`
    Break(u32),
    /// `continue`
    Continue,
    /// `display`
    Display(Vec<Shown>),
    /// `abort`: what to show, `abort.noError`
    Abort(Vec<Shown>, bool),
    /// `solve`
    Solve(Box<SolveCode>),
    /// `option name = value`
    Option(Box<str>, Box<str>),
    /// `option clear = p`, `option clear = x.lo`: the offset of the attribute
    Clear(SymbolId, Option<u32>),
    /// `option shuffle = p`: the parameter, and the set of its index
    Shuffle(SymbolId, TableId),
    /// `option p:d:r:c`
    Format(SymbolId, Vec<i64>),
    /// `option p < q`
    Project {
        /// Left side.
        target: SymbolId,
        /// Right side.
        source: SymbolId,
        /// For each position of the target the position of the source.
        positions: Vec<usize>,
    },
    /// `option p > s`: numbers of orders, and the set that is ordered.
    Permute(SymbolId, [TableId; 2]),
    /// `option m(i:j,k)`: sets that are matched with what stands before (true), or multiplied out.
    Match(SymbolId, Vec<(bool, TableId)>),
    /// `put` and its kin: keyword, items.
    Put(Box<str>, Vec<PutCode>),
    /// Data exchange.
    Exchange(crate::syntax::ast::Exchange),
    /// `draw`
    Draw(SymbolId, Option<Box<str>>),
}

impl Node {
    /// A node without variables.
    pub fn data(kind: NodeKind, span: Span) -> Node {
        Node {
            kind,
            span,
            has_var: false,
            linear: true,
            member: false,
        }
    }

    /// Two nodes of data and an operator between them.
    pub fn binary(op: BinaryOp, a: Node, b: Node, span: Span) -> Node {
        Node::data(NodeKind::Binary(op, Box::new(a), Box::new(b)), span)
    }

    /// A membership.
    pub fn membership(kind: NodeKind, span: Span) -> Node {
        Node {
            member: true,
            ..Node::data(kind, span)
        }
    }

    /// A number.
    pub fn number(x: f64, span: Span) -> Node {
        Node::data(NodeKind::Const(x), span)
    }
}
